"""What the tests of the Python package are given, and the line that each of them prints.

    python -m pytest tests/python [--anthronet PROGRAM] [--same-bytes FOLDER] [--wheel WHEEL]

They test the package that this Python imports: an installed one, or with PYTHONPATH=python and ANTHRONET_LIBRARY that
of the source tree. What needs an option that is not given is skipped.

`cargo xtask test` counts the lines `ok NAME`, `FAILED NAME: why` and `skipped NAME: why`. A name is the first line of
the test's documentation, and what it is run with. Fixtures import the package themselves, so that `interface/conftest.py`
comes before them.
"""

from pathlib import Path

import pytest


def pytest_addoption(parser):
    parser.addoption("--anthronet", type=Path, help="the command")
    parser.addoption("--same-bytes", type=Path, help="the folder that ffi/tests/same_bytes.rs leaves")
    parser.addoption("--wheel", type=Path, help="the package's wheel")


def given(config, option):
    value = config.getoption(option)
    if value is None:
        pytest.skip(f"{option} is not given")
    return value.resolve()


@pytest.fixture
def anthronet_command(pytestconfig):
    return given(pytestconfig, "--anthronet")


@pytest.fixture
def same_bytes(pytestconfig):
    return given(pytestconfig, "--same-bytes")


@pytest.fixture(scope="module")
def wheel(pytestconfig):
    return given(pytestconfig, "--wheel")


@pytest.fixture(scope="session")
def model():
    import anthronet

    return anthronet.default_model()


@pytest.fixture(scope="session")
def woman():
    import anthronet

    return anthronet.generate(sex="female", height=1.70)


@pytest.fixture(scope="session")
def heavy():
    """The woman, of a larger waist."""
    import anthronet

    return anthronet.generate(sex="female", height=1.70, waist_circumference=0.95)


@pytest.fixture(scope="session")
def man():
    import anthronet

    return anthronet.generate(sex="male", height=1.85)


def name_of(item):
    said = (item.function.__doc__ or item.name).strip().splitlines()[0].rstrip(".")
    return f"{said}: {item.callspec.id}" if hasattr(item, "callspec") else said


def why(item, call):
    """Where in the test's file it failed, and the first line of what it said."""
    frames = [entry for entry in call.excinfo.traceback if entry.path == item.path]
    here = f"line {frames[-1].lineno + 1}, `{str(frames[-1].statement).splitlines()[0].strip()}`: " if frames else ""
    return here + call.excinfo.exconly().splitlines()[0]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    report = (yield).get_result()
    report.line = None
    if report.skipped:
        report.line = f"skipped {name_of(item)}: {report.longrepr[2].removeprefix('Skipped: ')}"
    elif report.failed:
        report.line = f"FAILED {name_of(item)}: {why(item, call)}"
    elif report.when == "call":
        report.line = f"ok {name_of(item)}"


def pytest_report_teststatus(report):
    """No dots: a test has a line of its own."""
    return (report.outcome if report.line else ""), "", ""


@pytest.hookimpl(trylast=True)
def pytest_configure(config):
    config.pluginmanager.register(Lines(config.pluginmanager.get_plugin("terminalreporter")))


class Lines:
    def __init__(self, reporter):
        self.reporter = reporter

    def pytest_runtest_logreport(self, report):
        if report.line:
            self.reporter.write_line(report.line)
