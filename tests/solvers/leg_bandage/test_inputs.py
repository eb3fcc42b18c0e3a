"""What the bandage solver takes: sensor, start, laws, legs of one's own, identity of runs."""

from dataclasses import replace

import numpy as np
import pytest

from surrogate import Study
from surrogate.cli import standing
from surrogate.conformance import check_solver
from surrogate.errors import SolverError, StudyError
from surrogate.runs.identity import SolverSpec, keys
from surrogate.runs.identity import run_inputs as calls_of
from surrogate_solvers.leg_bandage.bandage.products import BANDAGES, CURVED, bandage, power_law
from surrogate_solvers.leg_bandage.geometry.basis import fit_basis
from surrogate_solvers.leg_bandage.geometry.cohort import load_cohort, write_cohort
from surrogate_solvers.leg_bandage.geometry.landmarks import MEDIAL, Disc, b1_height
from surrogate_solvers.leg_bandage.geometry.leg import Leg
from surrogate_solvers.leg_bandage.outputs.answers import _circle
from surrogate_solvers.leg_bandage.outputs.pressure_map import on_disc, pressure_map
from surrogate_solvers.leg_bandage.parameters import INPUTS, complete, shapes_in
from surrogate_solvers.leg_bandage.plugin import LegBandage


def test_the_declarations_keep_the_contract():
    """Units, ranges, levels and names, without a run."""
    check_solver(LegBandage(), runs=0)
    check_solver(LegBandage(fabric="biflex_17"), runs=0)
    check_solver(LegBandage(law="power"), runs=0)


def test_a_moved_sensor_reads_the_same_field_elsewhere(rough_result):
    """The mechanics does not feel the sensor: only what hangs on its place differs.

    It lies 6 mm around and 8 mm up, 10 mm from B1.
    """
    moved = LegBandage(mesh="rough").run(sensor_around=6.0, sensor_up=8.0)
    leg, values = rough_result.leg, rough_result.values
    sensor = Disc(MEDIAL, b1_height(leg)).moved(leg, 6.0, 8.0)
    expected, _ = on_disc(pressure_map(rough_result.model, rough_result.u), leg, sensor)
    assert moved.values["pressure_b1"] == expected != values["pressure_b1"]
    for name in ("pressure_b1_girth", "b1_height", "slip_max", "pressure_ankle"):
        assert moved.values[name] == values[name]
    assert np.array_equal(moved.values["pressure_field"], values["pressure_field"])


def test_profile_and_gradient_come_from_the_field_and_the_sensors(rough_result):
    """Mean around the leg at every height; calf over ankle."""
    values = rough_result.values
    np.testing.assert_allclose(values["pressure_profile"], values["pressure_field"].mean(axis=0))
    ratio = values["pressure_calf"] / values["pressure_ankle"]
    assert values["pressure_gradient"] == pytest.approx(ratio) and 0.2 < ratio < 3


def test_sensor_variation_is_the_mean_over_moved_sensors(rough_result):
    """Eight sensors on a circle of 10 mm, read as `sensor_around` and `sensor_up` move them."""
    places = _circle(10.0)
    assert (0.0, 10.0) == pytest.approx(places[2], abs=1e-12)
    found, sensor = (
        pressure_map(rough_result.model, rough_result.u),
        Disc(MEDIAL, b1_height(rough_result.leg)),
    )
    read = [
        on_disc(found, rough_result.leg, sensor.moved(rough_result.leg, *place))[0]
        for place in places
    ]
    mean = np.mean(np.abs(np.array(read) - rough_result.values["pressure_b1"]))
    assert rough_result.values["sensor_variation"] == pytest.approx(mean, rel=1e-12)


def test_a_disc_moves_by_true_lengths():
    """On a cone r = 30 + z / 10: up by 10 is 10 cos(half angle) high, around by 10 is 10 / r."""
    heights = np.linspace(0, 200.0, 100)
    coefficients = np.zeros((100, 11))
    coefficients[:, 0] = 30 + 0.1 * heights
    leg = Leg.from_sections(200.0, coefficients, np.zeros((100, 2)))
    up = Disc(1.0, 60.0).moved(leg, up=10.0)
    assert up.z - 60 == pytest.approx(10 * np.cos(np.arctan(0.1)), rel=1e-6)
    assert up.theta == 1.0
    around = Disc(1.0, 60.0).moved(leg, around=-10.0)
    assert around.theta - 1 == pytest.approx(-10 / 36, rel=1e-6)
    assert around.z == 60.0


def test_the_bandage_starts_where_it_is_told(rough_result):
    """A first end 30 mm higher leaves 30 mm less to climb: 0.6 turns at a pitch of 50 mm."""
    high = LegBandage(mesh="rough").run(start_height=20.0)
    assert rough_result.values["turns"] - high.values["turns"] == pytest.approx(30 / 50, rel=1e-9)
    assert high.model.lay.skin[:, :, 1].min() > rough_result.model.lay.skin[:, :, 1].min() + 25
    assert high.values["pressure_ankle"] < rough_result.values["pressure_ankle"]


@pytest.mark.parametrize("name", sorted(BANDAGES))
def test_curves_pass_through_the_secant_at_1_3(name):
    """Chassagne et al. 2018, equation 10, fixes the point (1.3, T); each curve says its ground.

    The curve is stiffer than the secant first, then softer, then stiffer again: an inflexion.
    """
    chosen = bandage(name)
    stretch, share = np.array(chosen.curve).T
    assert np.interp(1.3, stretch, share) == 1.0
    slope = np.diff(share) / np.diff(stretch) * 0.3
    assert slope[0] > 1.2 and slope.min() < 0.8 and slope[-1] > 1.0
    turn = slope.argmin()
    assert (np.diff(slope[: turn + 1]) <= 1e-9).all() and (np.diff(slope[turn:]) >= -1e-9).all()
    assert chosen.sources["curve"].split(":")[0] in ("assumed", "measured")


@pytest.mark.parametrize("fabric", [None, "biflex_16"])
def test_the_law_of_the_fabric_that_is_solved(fabric):
    """Both laws have the asked tension at stretch 1.3 and weft-free equation 10, or the curve."""
    solver = LegBandage(fabric=fabric)
    q = {name: one.nominal for name, one in solver.inputs.items()} | {"tension": 0.12}
    laws = {law: solver._material(q | {"tension_law": law}).fabric for law in ("secant", "curved")}
    assert [laws[law].tension(1.3) for law in laws] == pytest.approx([0.12, 0.12], rel=1e-12)
    assert laws["secant"].tension(1.4) == pytest.approx(0.16, rel=1e-12)
    assert laws["curved"].tension(1.4) == pytest.approx(0.12 * dict(CURVED)[1.4], rel=1e-12)


def test_a_power_law_with_an_exponent_that_can_be_learnt():
    """T = tension ((stretch - 1) / 0.3)^n; 0.64 is within 2 % of the assumed curve."""
    solver = LegBandage(law="power")
    assert "tension_law" not in solver.inputs
    q = {name: one.nominal for name, one in solver.inputs.items()} | {"tension": 0.12}

    def tension(exponent: float, stretch: float) -> float:
        return float(solver._material(q | {"exponent": exponent}).fabric.tension(stretch))

    for stretch in (1.12, 1.3, 1.44):
        assert tension(1.0, stretch) == pytest.approx(0.4 * (stretch - 1), rel=1e-9)
        exact = 0.12 * ((stretch - 1) / 0.3) ** 0.7
        assert tension(0.7, stretch) == pytest.approx(exact, rel=2e-3)
    close = dict(power_law(0.64))
    assert all(close[s] == pytest.approx(t, rel=0.02) for s, t in CURVED if 1.1 <= s <= 1.5)
    with pytest.raises(StudyError, match="law: 'powers' is unknown: did you mean 'power'"):
        LegBandage(law="powers")


@pytest.mark.slow
def test_the_curved_law_pays_for_its_stretch(result):
    """dP = dT / T P to first order: the midline comes to rest at 1.282 of 1.3.

    Where stretch is lost, tension falls by 0.6 of what the secant loses, so the pressure is
    higher, by less than the whole loss of the secant (6 %).
    """
    curved = LegBandage(mesh="coarse")(tension_law="curved")["pressure_b1"]
    assert 1.0 < curved / result.values["pressure_b1"] < 1.06


def test_a_leg_with_sections_of_its_own(rough_result):
    """The leg of four coordinates, given by its sections, is the same leg: the same answer."""
    solver = LegBandage(mesh="rough")
    leg = Leg.from_sections(
        rough_result.leg.length, rough_result.leg.coefficients, rough_result.leg.centre
    )
    own = solver.run(leg)
    assert own.leg.alphas is None
    assert own.values["pressure_b1"] == rough_result.values["pressure_b1"]
    with pytest.raises(SolverError, match="alpha1: the leg that is given has its own shape"):
        solver.run(leg, alpha1=-0.7)


def test_a_cohort_of_ones_own(tmp_path):
    """Nominal lengths and alphas are the cohort's means, and the leg is made on its basis."""
    whole = load_cohort("val")
    few = replace(
        whole,
        coefficients=whole.coefficients[:9],
        centre=whole.centre[:9],
        length=whole.length[:9],
        facts={},
    )
    write_cohort(tmp_path / "mine.npz", few)
    solver = LegBandage(cohort="mine.npz", folder=tmp_path)
    basis = fit_basis(few.snapshots(), 4)
    assert solver.inputs["leg_length"].nominal == pytest.approx(few.length.mean(), abs=0.05)
    for k in range(4):
        given = solver.inputs[f"alpha{k + 1}"]
        assert given.nominal == pytest.approx(basis.mean[k], abs=5e-5)
        assert given.range[0] < basis.ranges[k, 0] < basis.ranges[k, 1] < given.range[1]
        assert "9 legs in mine.npz" in given.source
    assert np.array_equal(solver.basis.modes, basis.modes)
    assert solver.inputs["tension"] == INPUTS["tension"]
    write_cohort(
        tmp_path / "two.npz",
        replace(
            few, coefficients=few.coefficients[:2], centre=few.centre[:2], length=few.length[:2]
        ),
    )
    with pytest.raises(StudyError, match="two.npz holds 2 legs; 4 modes need at least 5"):
        shapes_in("two.npz", tmp_path)


TWO = [{"product": "biflex_16"}, {"product": "biflex_17", "direction": "reversed"}]


def test_layers_bring_their_inputs():
    """The first bandage's are those without a number; padding brings thickness and stiffness."""
    solver = LegBandage(layers=[{"product": "wool"}, {**TWO[0], "overlap": 0.6}, TWO[1]])
    check_solver(solver, runs=0)
    nominal = {name: one.nominal for name, one in solver.inputs.items()}
    assert nominal["tension"] == pytest.approx(0.0785) and nominal["overlap"] == 0.6
    assert nominal["tension_2"] == pytest.approx(0.1175) and nominal["overlap_2"] == 0.5
    assert nominal["padding_thickness"] == 4.0
    assert solver.inputs["wrapping"].levels == ("prescribed",)
    assert "stretch_midline_2" in solver.outputs
    assert "stretch_2" not in LegBandage(layers=TWO[:1]).inputs
    assert "stretch_midline_2" not in LegBandage.outputs


@pytest.mark.parametrize(
    "layers, words",
    [
        ([], r"\[\] is no list of layers"),
        ([{"product": "wool"}], "0 bandages; 1 to 4 are taken"),
        ([{"product": "biflex_61"}], "biflex_16"),
        ([TWO[0], {"product": "wool"}], "layers.1.: wool is padding, .*: it is layer 0"),
        ([{**TWO[0], "direction": "back"}], "direction 'back': .*onward, reversed"),
        ([{**TWO[0], "strech": 1.2}], "'strech' is unknown: did you mean 'stretch'"),
        ([{**TWO[0], "stretch": 13}], "stretch 13 is no number between 1.05 and 1.6"),
    ],
)
def test_wrong_layers(layers, words):
    """The value, what is allowed, and which layer."""
    with pytest.raises(StudyError, match=words):
        LegBandage(layers=layers)


def test_layers_name_their_products():
    """A fabric beside them would be a second first bandage."""
    with pytest.raises(StudyError, match="leave one of the two out"):
        LegBandage(fabric="biflex_16", layers=TWO)


def test_one_layer_is_the_bandage_alone(rough):
    """The first of several is that of the inputs."""
    alone = LegBandage(mesh="rough", fabric="biflex_16")()["pressure_field"]
    layered = LegBandage(mesh="rough", layers=TWO[:1])()["pressure_field"]
    assert np.array_equal(layered, alone)


@pytest.mark.slow
def test_a_second_bandage_adds_its_pressure(result):
    """At B1 two bandages press with the sum of both, less what the first loses beneath the second.

    The first gives 25.1 mmHg at 0.0785 N/mm; pressure is proportional to the tension.
    """
    solver = LegBandage(mesh="coarse", layers=TWO)
    found = solver()
    alone = result.values["pressure_b1"] * (0.0785 + 0.1175) / 0.098
    assert found["pressure_b1"] == pytest.approx(alone, rel=0.04)
    assert found["layers_b1"] == pytest.approx(4, abs=0.1)
    assert found["stretch_midline"] < LegBandage(mesh="coarse", layers=TWO[:1])()["stretch_midline"]


def _key(inputs=None, **options):
    spec = SolverSpec("leg_bandage", LegBandage, options)
    return keys(spec, calls_of(spec, {"mu_skin": [0.2]}, inputs))[0]


def test_identity_of_runs(tmp_path):
    """Runs differ by what changes an answer: not by the linear solver, defaults, or a path."""
    cohort = load_cohort("val")
    for name in ("a.npz", "b.npz"):
        write_cohort(tmp_path / name, replace(cohort, facts={}))
    same = {
        _key(),
        _key(mesh="medium"),
        _key(linear_solver="superlu"),
        _key({"wrapping": "prescribed", "sensor_up": 0.0}),
    }
    assert len(same) == 1
    assert _key(cohort=str(tmp_path / "a.npz")) == _key(cohort=str(tmp_path / "b.npz"))
    others = [
        _key(mesh="coarse"),
        _key(end="held"),
        _key(b1_rule="profile"),
        _key(leg_ends="pinned"),
        _key(cohort=str(tmp_path / "a.npz")),
        _key({"wrapping": "progressive"}),
        _key({"tension_law": "curved"}),
        _key({"sensor_up": 5.0}),
        _key({"start_height": 0.0}),
        _key(fabric="biflex_16"),
        _key(law="power"),
        _key(layers=TWO),
        _key(layers=[TWO[0], {"product": "biflex_17"}]),
        _key({"overlap_2": 0.6}, layers=TWO),
    ]
    assert len({*same, *others}) == 1 + len(others)
    tension = LegBandage(fabric="biflex_16").inputs["tension"].nominal
    assert _key(fabric="biflex_16") == _key({"tension": tension})


@pytest.mark.parametrize("name", ["leg_bandage", "leg_bandage_patient"])
def test_a_study_may_ask_for_all_outputs(name):
    """No output has a name that the runs dataset needs for itself."""
    parameter = {
        "leg_bandage": {"overlap": [0.45, 0.55]},
        "leg_bandage_patient": {"stretch": [1.2, 1.3]},
    }[name]
    study = Study.from_mapping(
        {
            "study": "all",
            "solver": name,
            "parameters": parameter,
            "designs": {"train": {"method": "sobol", "runs": 2}},
        }
    )
    assert {"pressure_b1", "pressure_field", "slip_max"} <= set(study.outputs)


def test_check_tells_the_points_that_the_fabric_cannot_be(tmp_path):
    """nu12 and K2 in their ranges, and yet no energy minimum: counted by design before any run.

    Whether a call is refused agrees with the constraint at each point of the design.
    """
    (tmp_path / "few.csv").write_text("nu12,K2\n0.2,0.3\n")
    study = Study.from_mapping(
        {
            "study": "weft",
            "solver": {"name": "leg_bandage", "options": {"mesh": "coarse"}},
            "parameters": {"nu12": [0.0, 0.45], "K2": [0.01, 5.0]},
            "outputs": ["pressure_b1"],
            "designs": {"train": {"method": "full_factorial", "levels": 3},
                        "few": {"method": "csv", "path": str(tmp_path / "few.csv")}},
        }
    )  # fmt: skip
    train, few = study.designs["train"], study.designs["few"]
    assert (train.runs, few.runs) == (9, 1)
    refused = 0
    for point in zip(*study.space.decode(train.coded).values(), strict=True):
        values = complete(INPUTS, dict(zip(("nu12", "K2"), map(float, point), strict=True)))
        try:
            LegBandage(mesh="coarse")._material(values)
        except SolverError as error:
            assert "no minimum" in str(error)
            refused += 1
    (sentence,) = (one.sentence for one in LegBandage.constraints)
    assert study.broken_constraints == {"train": {sentence: refused}} and refused == 2
    page = standing.check(study, tmp_path / "results")
    assert f"2 of 9 points of train have no answer: {sentence}\n" in page.parts
    assert page.data["broken_constraints"] == study.broken_constraints
