"""The section `credibility:` of a study file: what only people know, for `surrogate dossier`."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from surrogate.study.parts.part import Part


class EvidencePart(Part):
    """A claim, with the command that shows it and what that gave."""

    claim: str = Field(description="What is claimed.", examples=["Capstan, half a turn, mu 0.2."])
    command: str = Field(
        "",
        description="Command that makes the result again.",
        examples=["python benchmarks/verification_contact.py"],
    )
    result: str = Field("", description="What it gave.", examples=["1.8763, exact 1.8745"])


def _claims(value: Any) -> Any:
    return ({"claim": value},) if isinstance(value, str) else value


#: A text, or a list of claims.
Claims = Annotated[
    tuple[EvidencePart, ...],
    BeforeValidator(_claims, json_schema_input_type=str | tuple[EvidencePart, ...]),
]


class CredibilityPart(Part):
    """What a reviewer asks and no run can tell (ASME V&V 40)."""

    question: str = Field(
        "",
        description="Question of interest: the decision that the model is to help with.",
        examples=["Which bandage gives 40 mmHg at B1 on this leg?"],
    )
    context: str = Field(
        "",
        description="Context of use: what the model says, for what, beside which other evidence.",
        examples=["The pressure at B1, beside a measurement on the patient."],
    )
    influence: str = Field(
        "",
        description="Influence of the model on the decision; begins with low, medium or high.",
        examples=["medium: the pressure is measured before the bandage is worn"],
    )
    consequence: str = Field(
        "",
        description="Consequence of a wrong decision; begins with low, medium or high.",
        examples=["low: the bandage is wrapped again"],
    )
    code_verification: Claims = Field(
        (),
        description="Checks that the solver solves its equations: a text, or claims with the "
        "command that shows each and what it gave.",
        examples=[
            [
                {
                    "claim": "Capstan, half a turn, mu 0.2.",
                    "command": "python benchmarks/verification_contact.py",
                    "result": "1.8763, exact 1.8745",
                }
            ]
        ],
    )
    calculation_verification: Claims = Field(
        (),
        description="Checks of the numerical error, such as refined meshes: a text, or claims.",
        examples=["The pressure at B1 changes by 0.3 % from the coarsest to the finest mesh."],
    )
