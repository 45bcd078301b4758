"""
A test
======

Text.
"""

import runningbond as rb

rb.read("wall-w3").run("limit").plot()
