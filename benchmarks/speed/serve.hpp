// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ctime>
#include <exception>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "problem_file.hpp"

namespace fairlead::speed {

/// Processor time of this process [s]: what others do on the machine counts only through the caches.
inline double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// How a solver is asked; each solver reads what it knows.
struct Settings {
    std::string variant;
    int max_iterations = 50;
    double damping = 1e-4;    ///< of the first step, relative to the diagonal of the Hessian
    double tolerance = 1e-9;  ///< relative decrease of the cost that ends the iterations
};

/// Answers on stdout what is asked on stdin, one line each, so that a driver can take turns between programs:
///   problem PATH                                                    -> ok
///   solve VARIANT MAX_ITERATIONS DAMPING TOLERANCE SECONDS          -> solves, seconds of each, iterations
///   write PATH                                                      -> ok; the last answer
/// `solve` repeats the same solve from the same start until SECONDS of processor time are spent, once at least.
/// Solver: prepare(problem) once, then solve(settings, seconds) -> Answer with the time of the solve itself.
template <class Solver>
int serve() try {
    std::ios::sync_with_stdio(false);
    Solver solver;
    Answer answer;
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string verb;
        std::string path;
        words >> verb;
        if (verb == "problem" && words >> path) {
            solver.prepare(read_problem(path));
            std::cout << "ok" << std::endl;
        } else if (verb == "write" && words >> path) {
            write_answer(path, answer);
            std::cout << "ok" << std::endl;
        } else if (verb == "solve") {
            Settings settings;
            double budget = 0.0;
            words >> settings.variant >> settings.max_iterations >> settings.damping >> settings.tolerance >> budget;
            double spent = 0.0;
            int solves = 0;
            do {
                double seconds = 0.0;
                answer = solver.solve(settings, seconds);
                spent += seconds;
                ++solves;
            } while (spent < budget);
            std::cout.precision(17);
            std::cout << solves << ' ' << spent / solves << ' ' << answer.iterations << std::endl;
        } else {
            throw std::runtime_error("unknown request: " + line);
        }
    }
    return 0;
} catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
}

}  // namespace fairlead::speed
