"""Figures of errors: against passes, time, settings and regions."""
