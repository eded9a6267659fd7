#pragma once
// stand<B>: all that grows in the meadow, alive on a device: trees, grass and flowers in one wind,
// their triangles anew each frame, and a coarse copy of the trees' surfaces that light meets.
//
//     auto stand = meadow::stand<B>::create(device, what, ground, now, view);
//     run(device, [&](auto& recorder) {
//         stand->advance(recorder, seconds, step);
//         stand->mesh(recorder);
//         stand->record_light_surfaces(recorder, scene.triangles(), first, first_material);
//     });
//     stand->for_each_draw([&](const drawable<B>& one) { … draw … });
//
// Trees are a trees::swaying_tree a species with branches in as much detail as is seen, grass is
// leaves on stems that sway alike. Advancing, meshing and copying allocate nothing.

#include <meadow/growth.hpp>
#include <skybark/kernels/surface_triangles.hpp>
#include <skybark/trees/build_skeleton.hpp>
#include <skybark/trees/swaying_tree.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace skybark::meadow {

/// How many triangles light meets at most: two a leaf, six a segment of wood.
struct light_budget {
    std::uint32_t leaves = 45'000;
    std::uint32_t wood = 4'500;
};

template <backend B>
class stand {
  public:
    using recorder = typename B::recorder;
    using tree_type = trees::swaying_tree<B, trees::detailed_branch_mesh<B>>;

    /// Grows everything, sends it to the device, and makes room for what is seen from `view`.
    /// Errors: bad_input where the wind is out of range; those of the device.
    [[nodiscard]] static result<stand> create(B& device, const description& what,
                                              const land& ground, const weather& now,
                                              const trees::view_detail& view,
                                              const light_budget& budget = {}) {
        stand made;
        made.view_ = view;
        if (auto done = made.plant_trees(device, what, ground, budget); !done) {
            return failure(done.error());
        }
        if (auto done = made.sow_grass(device, what, ground); !done) {
            return failure(done.error());
        }
        if (auto done = made.blow(device, now); !done) {
            return failure(done.error());
        }
        if (auto done = made.make_room(device); !done) {
            return failure(done.error());
        }
        return made;
    }

    /// Another wind from the next `advance` on; its gusts go on from where they are. Speed in m/s
    /// 10 m above the ground, direction in degrees from north.
    [[nodiscard]] result<void> set_wind(B& device, float speed, float from) {
        const auto table = trees::tabulate(wind_of(speed, from));
        return table ? wind_->change(device, *table, seconds_) : failure(table.error());
    }

    /// Appends one step of the sway to `seconds`, `step` s after the last one; a step of 0: the
    /// leaves flutter, nothing sways.
    void advance(recorder& to, double seconds, float step) {
        seconds_ = seconds;
        wind_->record(to, seconds);
        for (grove& each : groves_) {
            shared_air air{air_of(each.first, each.segments)};
            each.trees.advance(to, air, seconds, step);
        }
        if (grass_) {
            grass_->loads.record(to, grass_->sway.poses(), grass_air());
            grass_->sway.record(to, grass_->loads.loads(), step);
        }
    }

    /// From where it is looked at from the next `mesh` on.
    void look_from(const trees::view_detail& view) {
        view_ = view;
        for (grove& each : groves_) {
            each.trees.look_from(view);
        }
    }

    /// Appends the making of all triangles that are drawn.
    void mesh(recorder& to) const {
        for (const grove& each : groves_) {
            each.trees.mesh(to);
        }
        if (grass_) {
            const trees::leaf_motion<B> motion{grass_->sway.poses(), grass_air(), seconds_};
            for (const blades& kind : grass_->kinds) {
                kind.mesh.record(to, motion, view_);
            }
        }
    }

    /// Makes more room where the last frame's triangles did not fit: true if it did; then `mesh`
    /// again. Waits for the device.
    [[nodiscard]] result<bool> update(B& device) {
        bool grown = false;
        for (grove& each : groves_) {
            const auto more = each.trees.update(device);
            if (!more) {
                return failure(more.error());
            }
            grown = grown || *more;
        }
        if (grass_) {
            for (blades& kind : grass_->kinds) {
                const auto more = kind.mesh.grow(device);
                if (!more) {
                    return more;
                }
                grown = grown || *more;
            }
        }
        return grown;
    }

    /// Calls `draw(drawable<B>)` for everything.
    template <class Draw>
    void for_each_draw(Draw&& draw) const {
        for (const grove& each : groves_) {
            each.trees.for_each_wood([&](const buffer_view<B>& v, const draw_geometry<B>& g) {
                draw(drawable<B>{v, g, look::bark, each.bark, true});
            });
            each.trees.for_each_leaf([&](const buffer_view<B>& v, const draw_geometry<B>& g) {
                draw(drawable<B>{v, g, look::leaf, each.blade, true});
            });
        }
        if (!grass_) {
            return;
        }
        for (const blades& kind : grass_->kinds) {
            for (const auto& part : kind.mesh.parts()) {
                draw(drawable<B>{skybark::view<B>(part.vertices), kind.mesh.geometry(part),
                                 look::leaf, kind.material, false});
            }
        }
    }

    /// What the drawables' numbers mean.
    [[nodiscard]] std::span<const material> materials() const { return materials_; }

    /// Triangles that light meets: always as many.
    [[nodiscard]] std::uint32_t light_triangles() const { return light_triangles_; }
    /// What the same numbers mean for light.
    [[nodiscard]] std::vector<gather_material> light_materials() const {
        std::vector<gather_material> all;
        for (const material& each : materials_) {
            all.push_back(light_of(each));
        }
        return all;
    }
    /// Appends the triangles that light meets, where they are now; their materials count from
    /// `first_material`. Makes them on the device and reads them back.
    [[nodiscard]] result<void> describe_light(B& device, std::vector<gather_triangle>& to,
                                              std::uint32_t first_material = 0) const {
        auto room = device.create_buffer(std::uint64_t{light_triangles_} * sizeof(gather_triangle));
        if (!room) {
            return failure(room.error());
        }
        const buffer_view<B> all = skybark::view<B>(*room);
        if (auto done =
                run(device, [&](recorder& r) { record_light_surfaces(r, all, 0, first_material); });
            !done) {
            return done;
        }
        const std::size_t first = to.size();
        to.resize(first + light_triangles_);
        return read_back<B, gather_triangle>(device, *room, std::span(to).subspan(first));
    }
    /// Appends the rewriting of the triangles [first, first + light_triangles()) of `triangles`
    /// with where the sway has carried them.
    void record_light_surfaces(recorder& to, const buffer_view<B>& triangles, std::uint32_t first,
                               std::uint32_t first_material = 0) const {
        kernels::surface_triangles copy;
        copy.first = first;
        for (const grove& each : groves_) {
            const buffer_view<B> poses = each.trees.motion().poses();
            copy.material = first_material + each.bark;
            if (each.light_wood) {
                each.light_wood->record(to, poses);
                copy.indexed = 1;
                for (const auto& part : each.light_wood->parts()) {
                    copy_part(to, copy, skybark::view<B>(part.vertices),
                              each.light_wood->geometry(part).indices, part.triangles, triangles);
                }
            }
            each.light_leaves.record(to, {poses, air_of(each.first, each.segments), seconds_},
                                     quadrilaterals());
            copy.material = first_material + each.blade;
            copy.indexed = 0;
            for (const auto& part : each.light_leaves.parts()) {
                copy_part(to, copy, skybark::view<B>(part.vertices), skybark::view<B>(part.count),
                          2 * part.elements, triangles);
            }
        }
    }

    /// The box around all trees at rest.
    [[nodiscard]] const trees::bounding_box& box() const { return box_; }
    [[nodiscard]] std::uint64_t trees() const { return trees_; }
    [[nodiscard]] std::uint64_t segments() const { return segments_; } ///< that sway
    [[nodiscard]] std::uint64_t leaves() const { return leaves_; }     ///< and tufts, and flowers

    /// Triangles of the last frame: waits for the device.
    [[nodiscard]] result<std::uint64_t> triangles(B& device) const {
        std::uint64_t sum = 0;
        for (const grove& each : groves_) {
            const auto made = each.trees.triangles(device);
            if (!made) {
                return made;
            }
            sum += *made;
        }
        if (grass_) {
            for (const blades& kind : grass_->kinds) {
                for (const auto& part : kind.mesh.parts()) {
                    count_record made;
                    auto done = read_back<B, count_record>(device, part.count, {&made, 1});
                    if (!done) {
                        return failure(done.error());
                    }
                    sum += made.written;
                }
            }
        }
        return sum;
    }

  private:
    /// The trees of a species.
    struct grove {
        tree_type trees;
        trees::leaf_mesh<B> light_leaves;
        std::optional<trees::branch_mesh<B>> light_wood;
        std::uint32_t first = 0;    ///< place of the wind
        std::uint32_t segments = 0; ///< and of the skeleton
        std::uint32_t bark = 0;     ///< materials
        std::uint32_t blade = 0;
    };
    struct blades {
        trees::leaf_mesh<B> mesh;
        std::uint32_t material = 0;
    };
    struct grass {
        trees::sway<B> sway;
        trees::wind_loads<B> loads;
        std::vector<blades> kinds;
        std::uint32_t first = 0;
        std::uint32_t stems = 0;
    };
    /// Air that has been made for all: a part of it.
    struct shared_air {
        buffer_view<B> part;
        void record(recorder&, double) {}
        [[nodiscard]] buffer_view<B> air() const { return part; }
    };

    stand() = default;

    static constexpr double least_wind = 0.05; // m/s: a calm has gusts too weak to see

    /// Woods and hedges around slow the wind near the ground more than open country.
    [[nodiscard]] static trees::kaimal_gusts wind_of(float speed, float from) {
        trees::kaimal_gusts model;
        model.speed = speed < least_wind ? least_wind : static_cast<double>(speed);
        model.from = static_cast<double>(from);
        model.turbulence.waves = 64;
        model.profile.exponent = 0.2;
        return model;
    }
    /// A view in which every leaf is a quadrilateral, and none is left out.
    [[nodiscard]] static trees::view_detail quadrilaterals() {
        trees::view_detail view;
        view.camera = glm::vec3(0, 1e5f, 0);
        view.pixels_per_radian = 1;
        view.thin = 0;
        return view;
    }
    /// Lists with room for so many triangles a leaf.
    [[nodiscard]] static trees::leaf_mesh_options as_list(std::size_t leaves,
                                                          std::uint64_t triangles) {
        trees::leaf_mesh_options options;
        options.form = trees::mesh_form::list;
        options.room = leaves * triangles;
        return options;
    }

    [[nodiscard]] buffer_view<B> air_of(std::uint32_t first, std::uint32_t count) const {
        const buffer_view<B> all = wind_->air();
        return {all.buffer, first * sizeof(glm::vec4), count * sizeof(glm::vec4)};
    }
    [[nodiscard]] buffer_view<B> grass_air() const { return air_of(grass_->first, grass_->stems); }

    static void copy_part(recorder& to, kernels::surface_triangles& copy,
                          const buffer_view<B>& vertices, const buffer_view<B>& indices,
                          std::uint32_t count, const buffer_view<B>& triangles) {
        to.map(copy, {vertices, indices, triangles}, range{0, count});
        copy.first += count;
    }

    [[nodiscard]] std::uint32_t add(material&& one) {
        materials_.push_back(std::move(one));
        return static_cast<std::uint32_t>(materials_.size() - 1);
    }

    /// Notes where a skeleton's segments are asked for their wind, by their heights above the
    /// land. The place of the first one is at the start of a view.
    [[nodiscard]] std::uint32_t feel(const B& device, const land& ground,
                                     const trees::skeleton& of) {
        const std::uint64_t aligned =
            std::max<std::uint64_t>(1, device.limits().view_alignment / sizeof(glm::vec4));
        while (wind_places_.size() % aligned != 0) {
            wind_places_.emplace_back(0);
        }
        const auto first = static_cast<std::uint32_t>(wind_places_.size());
        for (glm::vec3 place : trees::segment_middles(of)) {
            place.y = std::max(0.1f, place.y - ground.height(place.x, place.z));
            wind_places_.push_back(place);
        }
        segments_ += of.size();
        return first;
    }

    [[nodiscard]] result<void> plant_trees(B& device, const description& what, const land& ground,
                                           const light_budget& budget) {
        const std::vector<tree_place> places = place_trees(what.trees, what.seed);
        auto grown = grow_trees(places, ground, what.seed);
        if (!grown) {
            return failure(grown.error());
        }
        trees_ = places.size();
        std::size_t leaves = 0;
        std::size_t wood = 0;
        for (const grown_trees& each : *grown) {
            leaves += each.leaves.size();
            wood += each.wood.size();
        }
        for (grown_trees& each : *grown) {
            const auto share = [](std::uint64_t of, std::size_t part, std::size_t whole) {
                return static_cast<std::size_t>(whole == 0 ? 0 : of * part / whole);
            };
            const light_budget own{
                static_cast<std::uint32_t>(share(budget.leaves, each.leaves.size(), leaves)),
                static_cast<std::uint32_t>(share(budget.wood, each.wood.size(), wood))};
            if (auto done = plant(device, ground, each, own); !done) {
                return done;
            }
        }
        return {};
    }

    [[nodiscard]] result<void> plant(B& device, const land& ground, grown_trees& of,
                                     const light_budget& budget) {
        typename tree_type::options_type options;
        options.branches.rings = 3;
        options.branches.room = 4 * of.wood.size();
        options.leaves = as_list(of.leaves.size(), 2);
        options.leaf_cover = of.leaf_cover;
        options.view = view_;
        auto living = tree_type::create(device, of.wood, of.leaves, {}, options);
        if (!living) {
            return failure(living.error());
        }
        const std::vector<leaf> coarse = coarse_leaves(of.leaves, budget.leaves, of.leaf_cover);
        auto light_leaves = trees::leaf_mesh<B>::create(device, coarse, as_list(coarse.size(), 2));
        if (!light_leaves) {
            return failure(light_leaves.error());
        }
        std::optional<trees::branch_mesh<B>> light_wood;
        if (budget.wood != 0) {
            trees::branch_mesh_options tubes;
            tubes.sides = 3;
            tubes.rings = 2;
            auto made =
                trees::branch_mesh<B>::create(device, thick_branches(of.wood, budget.wood), tubes);
            if (!made) {
                return failure(made.error());
            }
            light_wood = std::move(*made);
            light_triangles_ += static_cast<std::uint32_t>(light_wood->triangles());
        }
        for (const auto& part : light_leaves->parts()) {
            light_triangles_ += 2 * part.elements;
        }
        const trees::bounding_box box = trees::bounds(of.wood);
        box_.min = groves_.empty() ? box.min : glm::min(box_.min, box.min);
        box_.max = groves_.empty() ? box.max : glm::max(box_.max, box.max);
        leaves_ += of.leaves.size();
        const std::uint32_t first = feel(device, ground, of.wood);
        const std::uint32_t bark = add(std::move(of.bark));
        const std::uint32_t blade = add(std::move(of.blade));
        groves_.push_back({std::move(*living), std::move(*light_leaves), std::move(light_wood),
                           first, static_cast<std::uint32_t>(of.wood.size()), bark, blade});
        return {};
    }

    [[nodiscard]] result<void> sow_grass(B& device, const description& what, const land& ground) {
        auto grown = grow_grass(what.grass, ground, what.seed);
        if (!grown) {
            return failure(grown.error());
        }
        if (grown->stems.empty()) {
            return {};
        }
        std::vector<float> mass(grown->area);
        for (float& each : mass) {
            each *= trees::fresh_leaf_mass;
        }
        auto moving = trees::sway<B>::create(device, grown->stems, {}, mass);
        if (!moving) {
            return failure(moving.error());
        }
        auto loads = trees::wind_loads<B>::create(device, grown->stems, grown->area, {});
        if (!loads) {
            return failure(loads.error());
        }
        grass_.emplace(grass{std::move(*moving), std::move(*loads), {}, 0, 0});
        grass_->first = feel(device, ground, grown->stems);
        grass_->stems = static_cast<std::uint32_t>(grown->stems.size());
        for (grown_blades& kind : grown->kinds) {
            trees::leaf_mesh_options options = as_list(kind.blades.size(), 3);
            options.flutter = 0.12f;
            options.lean = 0.5f;
            options.quad = 45; // a tuft's picture hides its outline
            auto mesh = trees::leaf_mesh<B>::create(device, kind.blades, options);
            if (!mesh) {
                return failure(mesh.error());
            }
            leaves_ += kind.blades.size();
            grass_->kinds.push_back({std::move(*mesh), add(std::move(kind.blade))});
        }
        return {};
    }

    [[nodiscard]] result<void> blow(B& device, const weather& now) {
        auto made =
            trees::wind_field<B>::create(device, wind_places_, wind_of(now.wind, now.wind_from));
        if (!made) {
            return failure(made.error());
        }
        wind_ = std::make_unique<trees::wind_field<B>>(std::move(*made));
        wind_places_ = {};
        return {};
    }

    /// Meshes once, and makes room for what that needs.
    [[nodiscard]] result<void> make_room(B& device) {
        if (auto done = run(device, [&](recorder& r) { mesh(r); }); !done) {
            return done;
        }
        const auto grown = update(device);
        return grown ? result<void>{} : failure(grown.error());
    }

    trees::view_detail view_;
    std::vector<grove> groves_;
    std::optional<grass> grass_;
    // In a place of its own: what has been advanced holds views of its air.
    std::unique_ptr<trees::wind_field<B>> wind_;
    std::vector<glm::vec3> wind_places_; // until there is a wind
    std::vector<material> materials_;
    trees::bounding_box box_;
    double seconds_ = 0;
    std::uint32_t light_triangles_ = 0;
    std::uint64_t trees_ = 0;
    std::uint64_t segments_ = 0;
    std::uint64_t leaves_ = 0;
};

} // namespace skybark::meadow
