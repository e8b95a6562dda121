# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Landmarks and truth poses by hand, docs/your-own-target.md.

The document (`labels`, `document`, `journal`) knows no web; `solve`, `suggest`, `propagate` and `export` are functions
of it; `page` draws it in a browser, and is the only package that imports nicegui.
"""
