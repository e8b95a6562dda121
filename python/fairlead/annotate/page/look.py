# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Colours and style of the page."""

STYLE = """
body { background: #0f172a; color: #e2e8f0; }
.nicegui-content { padding: 0; gap: 0; }
.bar { background: #111c33; border-bottom: 1px solid #1e293b; }
.side { background: #111c33; border-left: 1px solid #1e293b; }
.box { background: #020617; overflow: auto; position: relative; }
.box > div { margin: auto; }
.box img { image-orientation: none; image-rendering: auto; cursor: crosshair; }
.box.near img { image-rendering: pixelated; }
.line { border-radius: 6px; cursor: pointer; padding: 3px 8px; flex-wrap: nowrap; }
.line:hover { background: #1e293b; }
.line.chosen { background: #334155; }
.dim { color: #94a3b8; }
.good { color: #4ade80; } .warn { color: #f87171; } .carried { color: #38bdf8; } .few { color: #fbbf24; }
.number { font-variant-numeric: tabular-nums; }
.key { border: 1px solid #475569; border-radius: 4px; padding: 0 5px; font-size: 11px; color: #cbd5e1; }
.q-tab__label { font-weight: 600; letter-spacing: 0.02em; }
.nicegui-scene { outline: none; }
.q-table__container { background: #111c33 !important; }
.q-table tbody tr { cursor: pointer; }
.q-table { font-variant-numeric: tabular-nums; }
.strip { cursor: pointer; }
"""
