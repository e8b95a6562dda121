# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Figures of the report; each method has the colour that it has everywhere."""
