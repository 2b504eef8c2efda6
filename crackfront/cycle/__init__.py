"""One approach and retraction: the load schedule, the fronts it visits and the record of both."""

from crackfront.cycle.energy import dissipated_energy
from crackfront.cycle.history import FrontHistory
from crackfront.cycle.record import Checkpoint, CycleRecord, CycleState, Keep
from crackfront.cycle.run import refuse_outgrown, run_cycle
from crackfront.cycle.schedule import DEFAULT_STEP, LoadSchedule, loads

__all__ = [
    "DEFAULT_STEP",
    "Checkpoint",
    "CycleRecord",
    "CycleState",
    "FrontHistory",
    "Keep",
    "LoadSchedule",
    "dissipated_energy",
    "loads",
    "refuse_outgrown",
    "run_cycle",
]
