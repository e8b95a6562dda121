// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/robust/loss.hpp"

#include <stdexcept>
#include <string>

namespace fairlead {

void validate(const Loss& loss) {
    if (loss.threshold > 0.0) return;
    throw std::invalid_argument("loss threshold: expected a number > 0, got " + std::to_string(loss.threshold));
}

}  // namespace fairlead
