# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""PyAV behind one door: the only package that imports av, and only when something of it is called."""
