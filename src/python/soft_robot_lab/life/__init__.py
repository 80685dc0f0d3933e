# SPDX-License-Identifier: BSD-3-Clause
"""A robot's whole life in one run: cast, simulated, taught, driven on an emulated rig, measured, fitted and taught again."""
