"""The only owner of xarray and netCDF: the schema, reading, writing and aggregation."""

from xarray import DataArray, Dataset

from crackfront.dataset.accuracy import (
    laws_text,
    read_coverage,
    read_errors,
    read_samples,
    write_coverage,
    write_errors,
    write_samples,
)
from crackfront.dataset.cycles import (
    cycle_dataset,
    cycle_record,
    read_checkpoint,
    read_cycle,
    read_simulation,
    write_checkpoint,
    write_cycle,
    write_simulation,
)
from crackfront.dataset.fields import PolarSamples, read_field, write_field
from crackfront.dataset.files import (
    UnreadableFileError,
    leftover_parts,
    read_attributes,
    replace_atomically,
    write_text,
)
from crackfront.dataset.fit import write_fit
from crackfront.dataset.loops import jump_dataset, loop_measures
from crackfront.dataset.quantities import in_reduced_units, in_si_units, refuse_other_units
from crackfront.dataset.records import (
    largest_differences,
    read_record,
    read_records,
    write_record,
    write_records,
)
from crackfront.dataset.surfaces import surface_adhesion, surface_array, surface_kind
from crackfront.dataset.tables import (
    COMPLETE,
    SweepRow,
    failed_row,
    read_statuses,
    read_table,
    row_fingerprint,
    sweep_row,
    write_hysteresis,
)

__all__ = [
    "COMPLETE",
    "DataArray",
    "Dataset",
    "PolarSamples",
    "SweepRow",
    "UnreadableFileError",
    "cycle_dataset",
    "cycle_record",
    "failed_row",
    "in_reduced_units",
    "in_si_units",
    "jump_dataset",
    "largest_differences",
    "laws_text",
    "leftover_parts",
    "loop_measures",
    "read_attributes",
    "read_checkpoint",
    "read_coverage",
    "read_cycle",
    "read_errors",
    "read_field",
    "read_record",
    "read_records",
    "read_samples",
    "read_simulation",
    "read_statuses",
    "read_table",
    "refuse_other_units",
    "replace_atomically",
    "row_fingerprint",
    "surface_adhesion",
    "surface_array",
    "surface_kind",
    "sweep_row",
    "write_checkpoint",
    "write_coverage",
    "write_cycle",
    "write_errors",
    "write_field",
    "write_fit",
    "write_hysteresis",
    "write_record",
    "write_records",
    "write_samples",
    "write_simulation",
    "write_text",
]
