// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#define BOOST_TEST_MODULE fairlead
#include <boost/test/unit_test.hpp>
