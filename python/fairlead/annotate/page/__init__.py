# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The page in the browser: thin, on NiceGUI, which brings its own assets. Nothing here computes."""
