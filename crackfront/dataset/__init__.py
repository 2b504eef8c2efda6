"""The only owner of xarray and netCDF: the schema, reading, writing and aggregation."""

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
    read_checkpoint,
    read_cycle,
    read_simulation,
    write_checkpoint,
    write_cycle,
    write_simulation,
)
from crackfront.dataset.fields import PolarSamples, read_field
from crackfront.dataset.files import (
    UnreadableFileError,
    leftover_parts,
    read_attributes,
    replace_atomically,
    write_text,
)
from crackfront.dataset.fit import write_fit
from crackfront.dataset.records import (
    largest_differences,
    read_record,
    read_records,
    write_record,
    write_records,
)
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
    "PolarSamples",
    "SweepRow",
    "UnreadableFileError",
    "failed_row",
    "largest_differences",
    "laws_text",
    "leftover_parts",
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
    "replace_atomically",
    "row_fingerprint",
    "sweep_row",
    "write_checkpoint",
    "write_coverage",
    "write_cycle",
    "write_errors",
    "write_fit",
    "write_hysteresis",
    "write_record",
    "write_records",
    "write_samples",
    "write_simulation",
    "write_text",
]
