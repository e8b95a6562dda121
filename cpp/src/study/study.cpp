// SPDX-FileCopyrightText: fairlead contributors
// SPDX-License-Identifier: Apache-2.0
#include "fairlead/study.hpp"

#include <atomic>
#include <ctime>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

#include "methods.hpp"

namespace fairlead::study {
namespace {

/// Time that this thread has had of a processor [s]: other threads and other programs do not count.
double processor_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Answer dispatch(Method method, const Camera& camera, const Flight& flight, const Options& options) {
    switch (method) {
        case Method::start:
            return start(camera, flight);
        case Method::single_view:
            return single_view(camera, flight);
        case Method::free_window:
            return free_window(camera, flight, options.free_window);
        case Method::map:
            return map(camera, flight, options.tracker);
        case Method::online:
            return online(camera, flight, options.tracker);
        case Method::true_model:
            return true_model(camera, flight, options.tracker.loss_threshold);
        case Method::bound:
            return bound(camera, flight);
    }
    throw std::invalid_argument("method: unknown");
}

/// Work that one thread after the other takes the next piece of; the first failure ends it.
class Share {
  public:
    Share(std::size_t count, int threads) : count_(count), threads_(threads) {}

    template <typename Work>
    void run(const Work& work) {
        const auto take = [&] {
            for (std::size_t i = next_++; i < count_; i = next_++) try {
                    work(i);
                } catch (...) {
                    const std::scoped_lock lock(mutex_);
                    if (!failure_) failure_ = std::current_exception();
                    next_ = count_;
                }
        };
        {
            std::vector<std::jthread> others;
            for (int t = 1; t < threads_; ++t) others.emplace_back(take);
            take();
        }
        if (failure_) std::rethrow_exception(failure_);
    }

  private:
    std::size_t count_;
    int threads_;
    std::atomic<std::size_t> next_{0};
    std::mutex mutex_;
    std::exception_ptr failure_;
};

}  // namespace

void validate(const Flight& flight) {
    const std::size_t views = flight.views.size();
    const auto rows = 3 * static_cast<Eigen::Index>(flight.X0.size());
    if (flight.stamps_ns.size() != views || flight.T_true.size() != views || flight.T_start.size() != views)
        throw std::invalid_argument("flight: expected a stamp, a true pose and a first pose of each of the " +
                                    std::to_string(views) + " views");
    if (flight.X_true.size() != flight.X0.size() || flight.P0.rows() != rows || flight.P0.cols() != rows)
        throw std::invalid_argument("flight: expected as many true landmarks as told ones and a covariance of " +
                                    std::to_string(rows) + " rows");
}

Answer solve(Method method, const Camera& camera, const Flight& flight, const Options& options) {
    validate(flight);
    const double before = processor_seconds();
    Answer answer = dispatch(method, camera, flight, options);
    answer.seconds = processor_seconds() - before;
    return answer;
}

std::vector<Answer> solve_all(Method method, const Camera& camera, std::span<const Flight> flights,
                              const Options& options, int threads) {
    if (threads < 1) throw std::invalid_argument("threads: expected at least 1, got " + std::to_string(threads));
    std::vector<Answer> answers(flights.size());
    Share(flights.size(), threads).run([&](std::size_t i) { answers[i] = solve(method, camera, flights[i], options); });
    return answers;
}

}  // namespace fairlead::study
