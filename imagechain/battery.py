"""Checks that every module must pass; run them on your own modules, in your tests."""

from nodes.module_battery import check_module, faults_of

__all__ = ["check_module", "faults_of"]
