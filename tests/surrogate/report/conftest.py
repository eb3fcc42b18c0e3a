"""The builder of made-up studies, for every test of the pages."""

from made_up import make
from pytest import fixture


@fixture(scope="session")
def study():
    """Builds the content of a page: see `made_up.make`."""
    return make
