// Any bytes as particles, at once and in pieces: an error in a sentence, or particles in their
// ranges.

#include <io/number_table.hpp>
#include <io/read_particles.hpp>

#include <cmath>
#include <cstdlib>
#include <string_view>

namespace {

void require(bool holds) {
    if (!holds)
        std::abort();
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace skybark;
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    const auto particles = io::parse_particles(text, "fuzz");
    require(particles || !particles.error().message.empty());
    if (particles) {
        require(!particles->empty());
        for (const cloud_particle& p : *particles) {
            require(std::isfinite(p.position.x + p.position.y + p.position.z));
            require(p.radius > 0 && p.optical_depth >= 0 && p.albedo >= 0 && p.albedo <= 1);
        }
    }
    // Where it is cut into pieces doesn't matter.
    const io::table_column columns[] = {{"x", -1e9, 1e9, "a number"}, {"albedo", 0, 1, "a number"}};
    const auto rows_of = [&](std::size_t piece) {
        std::size_t rows = 0;
        io::number_table table("fuzz", "rows", columns, [&](std::span<const double>) { ++rows; });
        result<void> good;
        for (std::size_t from = 0; good && from < text.size(); from += piece)
            good = table.take(text.substr(from, piece));
        if (good)
            good = table.finish();
        return good ? rows : ~std::size_t{0};
    };
    require(rows_of(text.size() + 1) == rows_of(1 + size % 7));
    return 0;
}
