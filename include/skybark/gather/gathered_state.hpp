#pragma once
// What a final gather has so far, as bytes that can be kept: a header, and the sums in an order
// that no device's limits change.

#include <skybark/core/bytes.hpp>
#include <skybark/core/result.hpp>
#include <skybark/core/when_used.hpp>

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace skybark::gather::detail {

/// A number that changes with whatever goes in: not against forgers. Bytes may come in runs of
/// eightfold length, cut anywhere; the last run may have any length.
class fingerprint {
  public:
    void add(std::span<const std::byte> bytes) {
        for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
            std::uint64_t word = 0;
            std::memcpy(&word, bytes.data(), 8);
            add_word(word);
        }
        if (!bytes.empty()) {
            std::uint64_t rest = 0;
            std::memcpy(&rest, bytes.data(), bytes.size());
            add_word(rest);
        }
    }
    template <class T>
    void add_value(const T& value) {
        add(bytes_of_one(value));
    }
    [[nodiscard]] std::uint64_t value() const noexcept { return state_; }

  private:
    void add_word(std::uint64_t word) noexcept {
        state_ = (state_ ^ word) * 0x9e3779b97f4a7c15u;
        state_ ^= state_ >> 29u;
    }
    std::uint64_t state_ = 0xcbf29ce484222325u;
};

/// The bytes that a saved gather begins with, as they lie in memory: of machines of one byte order.
struct state_header {
    std::array<char, 8> name{'S', 'K', 'Y', 'G', 'A', 'T', 'H', 'R'};
    std::uint32_t version = 1;
    std::uint32_t directional = 0;
    std::uint64_t asked = 0; ///< fingerprint of scene, samples and options
    std::uint64_t samples = 0;
    std::uint64_t axes = 0;
    std::uint64_t seed = 0;
    std::uint64_t content = 0; ///< fingerprint of what follows

    /// Bytes of what follows: sums of `replicates`, direct light, moments.
    [[nodiscard]] std::uint64_t content_bytes(std::uint64_t replicates) const {
        return samples * 16 * (replicates + 1 + (directional != 0 ? 3u : 0u));
    }
};
static_assert(sizeof(state_header) == 56);

/// The header of `bytes`, where they are whole and belong to a gather that has the header `mine`.
template <class = when_used>
[[nodiscard]] result<state_header> read_header(std::span<const std::byte> bytes,
                                               const state_header& mine, std::uint64_t replicates) {
    state_header header;
    const auto refuse = [](std::string why) {
        return fail(error_code::bad_input,
                    std::string("A saved gather can't be gone on with: ") + std::move(why));
    };
    if (bytes.size() < sizeof(header)) {
        return refuse("it has " + std::to_string(bytes.size()) + " bytes; expected at least " +
                      std::to_string(sizeof(header)) + ".");
    }
    std::memcpy(&header, bytes.data(), sizeof(header));
    if (header.name != mine.name) {
        return refuse("it does not begin with SKYGATHR, as saved gathers do.");
    }
    if (header.version != mine.version) {
        return refuse("it has version " + std::to_string(header.version) + "; expected " +
                      std::to_string(mine.version) + ".");
    }
    if (header.samples != mine.samples) {
        return refuse("it has " + std::to_string(header.samples) + " samples; expected " +
                      std::to_string(mine.samples) + ".");
    }
    if (header.directional != mine.directional) {
        return refuse(header.directional != 0
                          ? "it has directional light, which was not asked for."
                          : "it lacks the directional light that was asked for.");
    }
    if (header.asked != mine.asked) {
        return refuse("it was made for another scene, other samples or other options.");
    }
    const auto content = bytes.subspan(sizeof(header));
    if (content.size() != header.content_bytes(replicates)) {
        return refuse("it has " + std::to_string(bytes.size()) + " bytes; expected " +
                      std::to_string(sizeof(header) + header.content_bytes(replicates)) + ".");
    }
    fingerprint found;
    found.add(content);
    if (found.value() != header.content) {
        return refuse("its content is damaged.");
    }
    return header;
}

} // namespace skybark::gather::detail
