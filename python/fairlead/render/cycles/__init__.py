# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""Full quality: target and the sea about it by Cycles (`bpy`), laid over the fast renderer's sea and sky.

docs/rendering.md section 9.
"""
