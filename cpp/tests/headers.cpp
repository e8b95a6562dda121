// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
// Empty: the precompiled headers of the tests belong to a target, and a target needs a source that uses them.
