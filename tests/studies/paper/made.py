"""What tests of figures share: parameters of their files, records, and the claims that fail."""

from pathlib import Path

from crackfront.simulate.provenance import provenance
from studies.paper.figure import FIGURES, figure, load_figure
from studies.records import read_record, write_record

CONFIGURATIONS = Path(__file__).parents[3] / "config" / "figures"


def parameters(name, **changes):
    """Parameters of the file of a figure at the scale quick, with changes; errors as there."""
    figure_parameters = load_figure(CONFIGURATIONS / f"{name}.yaml", "quick")
    return type(figure_parameters).model_validate(figure_parameters.model_dump() | changes)


def with_measured(folder, name, text):
    """Configuration of a figure that names a file of measured points."""
    (folder / "measured.csv").write_text(text, encoding="utf-8")
    path, original = folder / f"{name}.yaml", (CONFIGURATIONS / f"{name}.yaml").read_text()
    line = f"parameters:\n  measured: {folder / 'measured.csv'}\n"
    path.write_text(original.replace("parameters:\n", line))
    return path


def computed(name, parameters_of):
    """Data of a figure."""
    return figure(name).compute(parameters_of, lambda line: None)


def figure_of(record):
    """Figure that has such data."""
    return next(
        figure_class for figure_class in map(figure, FIGURES) if figure_class.record is type(record)
    )


def failed(record):
    """Claims of a figure's data that fail."""
    return [check.claim for check in figure_of(record).checks(record) if not check.passed]


def is_labelled(panels):
    """Whether both axes of all panels have a label."""
    return all(axes.get_xlabel() and axes.get_ylabel() for axes in panels)


def drawn_from_file(record, folder):
    """Drawing of a record that was written and read."""
    write_record(folder / "record.nc", record, provenance(), title="test")
    return figure_of(record).draw(read_record(folder / "record.nc", type(record)))
