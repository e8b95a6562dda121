# SPDX-FileCopyrightText: fairlead contributors
# SPDX-License-Identifier: Apache-2.0
"""The fast renderer: OpenGL through moderngl, on a GPU or on the processor. docs/rendering.md section 5."""
