#pragma once
// What validated<B> says about layers that are peeled and bundles that are resolved. `Check` is
// the one of a recorder: it tells the first thing that is wrong with a call.

#include <skybark/core/backend.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace skybark::detail {

/// A view that is large enough for what `needs` so many bytes.
template <class Check, class View>
void check_room(Check& c, const View& v, const std::string& what, std::uint64_t bytes,
                const std::string& needs) {
    c.view(v, what);
    c.that(v.size >= bytes, what + " has " + std::to_string(v.size) + " bytes; " + needs + " has " +
                                std::to_string(bytes) + ".");
}

/// The picture that a peel takes and gives, apart from the buffers that its kernel reads.
template <class Check, class Layer, class Views>
void check_layer(Check& c, const Layer& layer, const Views& buffers, const device_limits& limits) {
    const std::string sides = std::to_string(layer.width) + " x " + std::to_string(layer.height);
    const std::uint64_t pixels = std::uint64_t{layer.width} * layer.height;
    c.that(pixels != 0, "a layer of " + sides + " pixels has no pixels.");
    c.that(std::max(layer.width, layer.height) <= limits.max_image_size,
           "a layer of " + sides + " pixels is longer than the " +
               std::to_string(limits.max_image_size) + " that a picture may be.");
    c.that(pixels <= limits.max_elements, "a layer of " + sides + " pixels has more than the " +
                                              std::to_string(limits.max_elements) +
                                              " elements that one call takes.");
    const std::string picture = "a word for each of " + sides + " pixels";
    check_room(c, layer.depth, "the view of the depths", pixels * 4, picture);
    check_room(c, layer.triangle, "the view of the triangles' numbers", pixels * 4, picture);
    check_room(c, layer.count, "the view of the count", sizeof(count_record), "a count_record");
    const std::array<std::pair<decltype(&layer.depth), const char*>, 3> written{
        {{&layer.depth, "the depths"},
         {&layer.triangle, "the triangles' numbers"},
         {&layer.count, "the count"}}};
    for (std::size_t i = 0; i < written.size(); ++i) {
        for (std::size_t j = i + 1; j < written.size(); ++j) {
            c.apart(*written[i].first, written[i].second, *written[j].first, written[j].second);
        }
        for (std::size_t j = 0; j < buffers.size(); ++j) {
            c.apart(buffers[j], "buffer " + std::to_string(j), *written[i].first,
                    written[i].second);
        }
    }
}

/// Axes of unit length, a lift that is not negative, and a grid that has cells.
template <class Check>
void check_bundle(Check& c, const ray_bundle& bundle) {
    const auto unit = [&](const glm::vec4& axis, const char* what) {
        const double length =
            std::sqrt(double{axis.x} * axis.x + double{axis.y} * axis.y + double{axis.z} * axis.z);
        c.that(std::fabs(length - 1) < 1e-3, std::string("the bundle's ") + what +
                                                 " is no unit vector: it is " +
                                                 std::to_string(length) + " long.");
    };
    unit(bundle.right, "right");
    unit(bundle.up, "up");
    unit(bundle.direction, "direction");
    c.that(bundle.right.w >= 0 && std::isfinite(bundle.right.w),
           "the bundle lifts its samples by " + std::to_string(bundle.right.w) +
               " m, which cannot be meant.");
    c.that(bundle.direction.w >= 1 && bundle.direction.w <= 32768,
           "the bundle's finest grid has " + std::to_string(bundle.direction.w) +
               " cells on a side; it has 1 to 32768.");
}

/// Whole records in every view, a hit for every sample, and nothing read that is written.
template <class Check, class Work>
void check_bundle_work(Check& c, const Work& work, const device_limits& limits) {
    const auto whole = [&](const auto& v, const char* what, std::uint64_t bytes) {
        c.view(v, std::string("the view of the ") + what);
        c.that(v.size % bytes == 0, std::string("the view of the ") + what + " has " +
                                        std::to_string(v.size) + " bytes, which are not whole " +
                                        "records of " + std::to_string(bytes) + ".");
        c.that(v.size / bytes <= limits.max_elements,
               std::to_string(v.size / bytes) + " " + what + " are more than the " +
                   std::to_string(limits.max_elements) + " that one call takes.");
    };
    whole(work.triangles, "triangles", sizeof(gather_triangle));
    whole(work.samples, "samples", sizeof(gather_sample));
    whole(work.hits, "hits", sizeof(gather_hit));
    const std::uint64_t triangles = work.triangles.size / sizeof(gather_triangle);
    c.that(triangles <= no_surface / 2,
           std::to_string(triangles) + " triangles are more than a hit can number.");
    const std::uint64_t samples = work.samples.size / sizeof(gather_sample);
    const std::uint64_t hits = work.hits.size / sizeof(gather_hit);
    c.that(hits >= samples, "there are " + std::to_string(samples) + " samples, and room for " +
                                std::to_string(hits) + " hits.");
    c.apart(work.triangles, "the triangles", work.hits, "the hits");
    c.apart(work.samples, "the samples", work.hits, "the hits");
    if (work.alpha) {
        c.view(work.alpha, "the view of the alpha maps");
        c.apart(work.alpha, "the alpha maps", work.hits, "the hits");
    }
}

} // namespace skybark::detail
