// C++17 on top of abf.h: results free themselves, failures are exceptions, and so are exceptions of callbacks.
#ifndef ABF_HPP
#define ABF_HPP

#include "abf.h"

#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace abf {

// A status with its sentence.
struct Error : std::runtime_error {
    AbfStatus status;
    explicit Error(AbfStatus s) : std::runtime_error(abf_last_error()), status(s) {}
};

inline void check(AbfStatus status) {
    if (status != ABF_STATUS_OK) throw Error(status);
}

// A result with its view.
class Result {
    std::unique_ptr<AbfResult, void (*)(AbfResult *)> owned_{nullptr, abf_result_free};
    AbfView view_{};

  public:
    explicit Result(AbfResult *result) : owned_(result, abf_result_free) {
        view_.size = sizeof view_;
        check(abf_result_view(result, &view_));
    }
    const AbfView &operator*() const noexcept { return view_; }
    const AbfView *operator->() const noexcept { return &view_; }
};

// Settings. `on_progress` may throw: the run is aborted, and the exception comes out of the call.
struct Options : AbfOptions {
    std::function<int(const AbfEvent &)> on_progress;
    Options() : AbfOptions{} { size = sizeof(AbfOptions); }
};

namespace detail {
template <class Call> Result run(const Options &options, Call call) {
    struct Host {
        const Options *options;
        std::exception_ptr thrown;
    } host{&options, nullptr};
    AbfOptions plain = options;
    if (options.on_progress) {
        plain.user = &host;
        plain.progress = [](void *user, const AbfEvent *event) -> std::int32_t {
            auto &told = *static_cast<Host *>(user);
            try {
                return told.options->on_progress(*event);
            } catch (...) {
                told.thrown = std::current_exception();
                return ABF_ABORT;
            }
        };
    }
    AbfResult *result = nullptr;
    const AbfStatus status = call(&plain, &result);
    if (host.thrown) {
        abf_result_free(result);
        std::rethrow_exception(host.thrown);
    }
    check(status);
    return Result(result);
}
} // namespace detail

// Flattens a disk: three numbers per vertex, three vertices per triangle.
inline Result flatten(const std::vector<double> &positions, const std::vector<std::uint32_t> &indices,
                      const Options &options = {}) {
    return detail::run(options, [&](const AbfOptions *plain, AbfResult **result) {
        return abf_flatten(positions.data(), positions.size() / 3, indices.data(), indices.size(), plain, result);
    });
}

// Relaxes UVs, two numbers per vertex; or per UV, with the UV of every index.
inline Result relax(const std::vector<double> &positions, const std::vector<std::uint32_t> &indices,
                    const std::vector<double> &uv, const std::vector<std::uint32_t> &uv_indices = {},
                    const Options &options = {}) {
    if (!uv_indices.empty() && uv_indices.size() != indices.size()) {
        throw std::invalid_argument("uv_indices must have an entry for every index");
    }
    const std::uint32_t *corners = uv_indices.empty() ? nullptr : uv_indices.data();
    return detail::run(options, [&](const AbfOptions *plain, AbfResult **result) {
        return abf_relax(positions.data(), positions.size() / 3, indices.data(), indices.size(), uv.data(), uv.size() / 2,
                         corners, plain, result);
    });
}

// Unwraps any mesh into an atlas.
inline Result unwrap(const std::vector<float> &positions, const std::vector<std::uint32_t> &indices,
                     const Options &options = {}) {
    return detail::run(options, [&](const AbfOptions *plain, AbfResult **result) {
        return abf_unwrap(positions.data(), positions.size() / 3, 0, indices.data(), indices.size(), plain, result);
    });
}

} // namespace abf

#endif
