// How often methods meet something else than Embree's watertight rays do, as a table in Markdown.
//
//   skybark_hit_table [SAMPLES [DIRECTIONS]]     points on each scene (65536), bundles (8)
//
// other hits: the share of all rays that meet something where Embree's meet nothing, or the other
// way round; other distances: of those that meet another place, by more than 2e-5 of the diagonal
// of the scene's box.

#include "../devices.hpp"
#include "../gather_work.hpp"

#include <scenes/embree_reference.hpp>
#include <skybark/gather/bundle_peeler.hpp>
#include <skybark/gather/bundle_resolver.hpp>

#include <cstdio>
#include <cstdlib>

namespace skybark::benchmarks {
namespace {

using scenes::hit_differences;

/// What all methods are given, and what they should find.
struct expected_hits {
    const gather_work* work;
    std::vector<ray_bundle> bundles;
    std::vector<std::vector<gather_hit>> hits; ///< by bundle
};

[[nodiscard]] expected_hits expect(const gather_work& work, std::uint32_t directions) {
    const scenes::embree_reference reference(work.scene.triangles);
    expected_hits all{&work, {}, {}};
    for (std::uint32_t i = 0; i < directions; ++i) {
        const std::uint32_t cells = gather::default_cells(work.scene.triangles.size());
        all.bundles.push_back(gather::make_bundle(work.box, axis_of(i), cells, work.lift));
        auto& hits = all.hits.emplace_back();
        for (const gather_sample& s : work.samples) {
            hits.push_back(reference.first_hit(all.bundles.back(), s));
        }
    }
    return all;
}

/// A scene and its points on a device, and what was found there.
template <backend B>
class tested_device {
  public:
    [[nodiscard]] static result<tested_device> create(B& device, const expected_hits& expected) {
        tested_device made(device, expected);
        auto triangles = make_buffer<B, gather_triangle>(device, expected.work->scene.triangles);
        auto samples = make_buffer<B, gather_sample>(device, expected.work->samples);
        auto hits = device.create_buffer(expected.work->samples.size() * sizeof(gather_hit));
        for (const auto& [slot, buffer] :
             {std::pair{&made.triangles_, &triangles}, std::pair{&made.samples_, &samples},
              std::pair{&made.hits_, &hits}}) {
            if (!*buffer) {
                return failure(buffer->error());
            }
            slot->emplace(std::move(**buffer));
        }
        return made;
    }

    [[nodiscard]] result<hit_differences> resolved(gather::resolve_route route) {
        gather::resolver_options options;
        options.route = route;
        auto resolver = gather::bundle_resolver<B>::create(
            *device_, expected_->work->scene.triangles.size(), options);
        if (!resolver) {
            return failure(resolver.error());
        }
        return compared([&](const ray_bundle& bundle) {
            return run(*device_,
                       [&](auto& recorder) { resolver->record(recorder, bundle, views()); });
        });
    }

    [[nodiscard]] result<hit_differences> peeled(std::uint32_t size) {
        gather::peeler_options options;
        options.size = size;
        auto peeler = gather::bundle_peeler<B>::create(*device_, options);
        if (!peeler) {
            return failure(peeler.error());
        }
        return compared([&](const ray_bundle& bundle) -> result<void> {
            const auto layers = peeler->resolve(bundle, expected_->work->box, views());
            return layers ? result<void>{} : failure(layers.error());
        });
    }

  private:
    tested_device(B& device, const expected_hits& expected)
        : device_(&device), expected_(&expected) {}

    [[nodiscard]] bundle_work<B> views() const {
        return {view<B>(*triangles_), {}, view<B>(*samples_), view<B>(*hits_)};
    }

    template <class Find>
    [[nodiscard]] result<hit_differences> compared(Find&& find) {
        hit_differences all;
        std::vector<gather_hit> found(expected_->work->samples.size());
        const double tolerance = 2e-5 * static_cast<double>(expected_->work->box.diagonal());
        for (std::size_t i = 0; i < expected_->bundles.size(); ++i) {
            auto done = find(expected_->bundles[i]);
            done = done ? read_back<B>(*device_, *hits_, std::span(found)) : done;
            if (!done) {
                return failure(done.error());
            }
            for (std::size_t k = 0; k < found.size(); ++k) {
                all.add(found[k], expected_->hits[i][k], tolerance);
            }
        }
        return all;
    }

    B* device_;
    const expected_hits* expected_;
    std::optional<typename B::buffer> triangles_;
    std::optional<typename B::buffer> samples_;
    std::optional<typename B::buffer> hits_;
};

void print(const expected_hits& expected, const std::string& method,
           const result<hit_differences>& found) {
    if (!found) {
        std::printf("| %s | %s | %s | |\n", expected.work->scene.name.c_str(), method.c_str(),
                    found.error().message.c_str());
    } else {
        std::printf("| %s | %s | %.2g | %.2g |\n", expected.work->scene.name.c_str(),
                    method.c_str(), found->share(found->other_hits),
                    found->share(found->other_distances));
    }
    std::fflush(stdout);
}

template <backend B>
void print_backend(const expected_hits& expected, const char* name) {
    const auto device = device_of<B>::get();
    auto tested = device ? tested_device<B>::create(**device, expected) : failure(device.error());
    if (!tested) {
        std::printf("| %s | %s | %s | |\n", expected.work->scene.name.c_str(), name,
                    tested.error().message.c_str());
        return;
    }
    print(expected, std::string("resolve, ") + name,
          tested->resolved(gather::resolve_route::fastest));
    if (std::same_as<B, cpu::device>) {
        print(expected, "resolve, composed", tested->resolved(gather::resolve_route::composed));
    }
    for (const std::uint32_t size : {256u, 512u, 1024u}) {
        print(expected, std::string("peel, ") + name + ", " + std::to_string(size) + "²",
              tested->peeled(size));
    }
}

} // namespace
} // namespace skybark::benchmarks

int main(int count, char** arguments) {
    using namespace skybark;
    using namespace skybark::benchmarks;
    const auto number = [&](int i, std::uint32_t usual) {
        return count > i ? static_cast<std::uint32_t>(std::strtoul(arguments[i], nullptr, 10))
                         : usual;
    };
    std::puts("| scene | method | other hits | other distances |\n|---|---|---|---|");
    for (const char* scene : scenes::scene_names) {
        const expected_hits expected =
            expect(work_of(scene, std::max(number(1, 65536), 1u)), number(2, 8));
        print_backend<cpu::device>(expected, "cpu");
        print_backend<opengl::device>(expected, "opengl");
        print_backend<vulkan::device>(expected, "vulkan");
    }
    return 0;
}
