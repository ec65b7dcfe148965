"""Ctrl-C reaches the tests and the programs that they start, even if a shell has started all of them with SIGINT ignored (`ctest &`)."""

import signal

signal.signal(signal.SIGINT, signal.default_int_handler)
