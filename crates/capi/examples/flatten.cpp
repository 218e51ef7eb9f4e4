// Flattens a dome: c++ -std=c++17 flatten.cpp $(pkg-config --cflags --libs abf)
#include <abf.hpp>

#include <cmath>
#include <cstdio>

int main() try {
    constexpr std::uint32_t n = 40;
    std::vector<double> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i <= n; ++i)
        for (std::uint32_t j = 0; j <= n; ++j) {
            const double x = 2.0 * i / n - 1, y = 2.0 * j / n - 1;
            positions.insert(positions.end(), {x, y, std::exp(-2 * (x * x + y * y))});
            if (i < n && j < n) {
                const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
                indices.insert(indices.end(), {a, b, b + 1, a, b + 1, a + 1});
            }
        }

    abf::Options options;
    options.solver = "linabf";
    options.on_progress = [](const AbfEvent &event) {
        if (event.kind == ABF_EVENT_KIND_ITERATION) std::printf("pass %u: %.1e\n", event.iteration, event.residual);
        return ABF_CONTINUE;
    };
    const abf::Result flat = abf::flatten(positions, indices, options);
    std::printf("%zu vertices, angle error %.3e, valid %d\n", flat->vertex_count, flat->angle_error, flat->valid);
    return flat->certified ? 0 : 1;
} catch (const abf::Error &error) {
    std::fprintf(stderr, "%s: %s\n", abf_status_name(error.status), error.what());
    return 2;
}
