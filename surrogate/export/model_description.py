"""modelDescription.xml of an FMU: variables, units, ranges, start values (FMI 2.0.4, 2.2)."""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree import ElementTree as xml

import numpy as np

from surrogate.export.description import Description, Input
from surrogate.space import units

#: Base units of FMI and pint's names of their dimensions.
BASE = {
    "kg": "[mass]",
    "m": "[length]",
    "s": "[time]",
    "A": "[current]",
    "K": "[temperature]",
    "mol": "[substance]",
    "cd": "[luminosity]",
}


def model_description(description: Description, guid: str) -> str:
    """The document; `guid` names it."""
    name, one = description.name, description
    root = xml.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=name,
        guid=guid,
        description=one.lines()[0],
        generationTool="surrogate-studies",
        variableNamingConvention="structured" if one.shape else "flat",
    )
    unit = xml.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=name,
        canHandleVariableCommunicationStepSize="true",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    sources = xml.SubElement(unit, "SourceFiles")
    for file in ("fmu.c", f"{name}.c"):
        xml.SubElement(sources, "File", name=file)
    defined = xml.SubElement(root, "UnitDefinitions")
    for unit_name in dict.fromkeys([*(entry.unit for entry in one.inputs), one.unit]):
        if unit_name:
            _add_unit(defined, unit_name)
    if not len(defined):
        root.remove(defined)
    variables = xml.SubElement(root, "ModelVariables")
    for entry in one.inputs:
        _add_input(variables, entry)
    outputs = [*_outputs(one, name, "mean"), *_outputs(one, f"{name}_std", "standard deviation")]
    for output, about in outputs:
        _add_output(variables, output, about, one.unit)
    structure = xml.SubElement(root, "ModelStructure")
    for part in ("Outputs", "InitialUnknowns"):
        listed = xml.SubElement(structure, part)
        for index in range(len(one.inputs) + 1, len(variables) + 1):
            xml.SubElement(listed, "Unknown", index=str(index))
    xml.indent(root)
    return xml.tostring(root, encoding="unicode", xml_declaration=False) + "\n"


def _outputs(one: Description, name: str, what: str) -> Iterator[tuple[str, str]]:
    """Names of all places of an output, fields counted from 1 in C order, and what they are."""
    about = f"{what}, {one.about or one.output}"
    if not one.shape:
        yield name, about
        return
    for place in np.ndindex(*one.shape):
        at = zip(one.coordinates, place, strict=True)
        where = ", ".join(f"{along.name} = {along.values[k]}" for along, k in at)
        yield f"{name}[{','.join(str(k + 1) for k in place)}]", f"{about}, at {where}"


def _add_input(variables: xml.Element, entry: Input) -> None:
    variable = _variable(variables, entry.name, entry.description, entry.told, causality="input")
    kind, write = ("Integer", _whole) if entry.whole else ("Real", repr)
    variable.set("variability", "discrete" if entry.whole else "continuous")
    attributes = {"start": write(entry.start)}
    if entry.ends is not None:
        attributes |= {"min": write(entry.ends[0]), "max": write(entry.ends[1])}
    if entry.unit and not entry.whole:
        attributes["unit"] = entry.unit
    xml.SubElement(variable, kind, attributes)


def _add_output(variables: xml.Element, name: str, about: str, unit: str) -> None:
    variable = _variable(variables, name, about, causality="output")
    variable.set("variability", "continuous")
    variable.set("initial", "calculated")
    xml.SubElement(variable, "Real", {"unit": unit} if unit else {})


def _variable(variables: xml.Element, name: str, *about: str, causality: str) -> xml.Element:
    words = "; ".join(" ".join(part.split()) for part in about if part)
    number = str(len(variables))
    return xml.SubElement(
        variables,
        "ScalarVariable",
        name=name,
        valueReference=number,
        description=words,
        causality=causality,
    )


def _whole(value: float) -> str:
    return str(round(value))


def _add_unit(defined: xml.Element, name: str) -> None:
    """A unit, in base units where pint knows it."""
    unit = xml.SubElement(defined, "Unit", name=name)
    if not units.known(name):
        return
    dimension = units.dimension(name)
    exponents = {base: float(str(dimension.get(of, 0))) for base, of in BASE.items()}
    if set(dimension) <= set(BASE.values()) and all(map(float.is_integer, exponents.values())):
        line = units.conversion(name, units.base_unit(name))
        powers = {base: str(int(power)) for base, power in exponents.items() if power}
        at = {"factor": repr(line.slope), "offset": repr(line.offset)}
        xml.SubElement(unit, "BaseUnit", powers | at)
