# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""A mesh and its landmarks -> images with exact truth. docs/rendering.md.

Heavy modules (moderngl, embreex, bpy) are imported where they are used, and only in here.
"""
