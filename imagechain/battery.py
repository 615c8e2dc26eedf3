"""What must hold of any module: those who write one run it over theirs, in their tests."""

from nodes.module_battery import check_module, faults_of

__all__ = ["check_module", "faults_of"]
