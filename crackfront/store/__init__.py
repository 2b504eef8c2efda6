"""The store of a sweep: what is finished, what is missing or stale, and the run that fills it.

Every finished simulation has a file in `curves/` and a row in the journal of the process that ran
it; one that cannot be done has its row alone. What is there is found by the journals, by the
sizes of the files, and, where a process ended between the two, by reading the file.
"""

from crackfront.store.archive import write_archive
from crackfront.store.inventory import Inventory, Stale
from crackfront.store.progress import Progress, sweep_progress
from crackfront.store.store import Store
from crackfront.store.tasks import NOT_STORED, STOPPED, Finished

__all__ = [
    "NOT_STORED",
    "STOPPED",
    "Finished",
    "Inventory",
    "Progress",
    "Stale",
    "Store",
    "sweep_progress",
    "write_archive",
]
