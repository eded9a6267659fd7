#pragma once
// The tree command on a device of any backend.

#include "skeleton_layout.hpp"
#include "tree_job.hpp"

#include <io/branch_carriers.hpp>
#include <picture/tree_picture.hpp>
#include <skybark/trees/swaying_tree.hpp>

#include <cmath>

namespace skybark::tool {

/// What the job's pictures show.
[[nodiscard]] inline picture::picture_options picture_of(const tree_job& job) {
    picture::picture_options options;
    options.width = job.common.width;
    options.height = job.common.height;
    options.eye = job.more.camera;
    options.target = job.more.look_at;
    return options;
}

/// The job's tree on a device, from frame to frame.
template <backend B, class Mesh>
class tree_frames {
  public:
    tree_frames(B& device, tree_job& job, trees::swaying_tree<B, Mesh> tree,
                std::optional<trees::wind_field<B>> air)
        : device_(device), job_(job), tree_(std::move(tree)), air_(std::move(air)),
          files_(job.out, job.common.width, job.common.height, job.more.frames, job.more.fps) {}

    /// Everything that the job asks for.
    [[nodiscard]] result<void> make() {
        for (std::uint32_t frame = 0; frame < job_.more.frames; ++frame) {
            result<void> done = sway_until(job_.more.seconds_of(frame));
            if (done) {
                done = is_animated_mesh() ? keep_pose() : finish(frame);
            }
            if (!done) {
                return done;
            }
        }
        result<void> done;
        if (is_animated_mesh()) {
            done = save_animation();
        } else {
            done = files_.commit();
        }
        return done;
    }

  private:
    static constexpr double longest_step = 1.0 / 60;

    [[nodiscard]] bool is_animated_mesh() const {
        return job_.kind == tree_output::glb && job_.more.frames > 1;
    }

    /// Goes on in equal steps of a sixtieth of a second at most. A calm needs none.
    [[nodiscard]] result<void> sway_until(double seconds) {
        if (!air_ || !(seconds > now_)) {
            return {};
        }
        job_.time.begin("sway");
        const double from = now_;
        const auto steps =
            static_cast<std::uint32_t>(std::max(1.0, std::ceil((seconds - from) / longest_step)));
        const double step = (seconds - from) / steps;
        for (std::uint32_t i = 1; i <= steps; ++i) {
            now_ = i == steps ? seconds : from + i * step;
            auto done = run(device_, [&](typename B::recorder& to) {
                tree_.advance(to, *air_, now_, static_cast<float>(step));
            });
            if (!done) {
                return done;
            }
        }
        return {};
    }

    /// Meshes the frame, and draws or saves it.
    [[nodiscard]] result<void> finish(std::uint32_t frame) {
        if (auto done = mesh(); !done) {
            return done;
        }
        switch (job_.kind) {
        case tree_output::picture:
        case tree_output::animation:
            return draw(frame);
        default:
            return save(frame);
        }
    }

    /// Makes the triangles; once more where a list had too little room.
    [[nodiscard]] result<void> mesh() {
        job_.time.begin("mesh");
        for (bool again = true; again;) {
            if (auto done = run(device_, [&](auto& to) { tree_.mesh(to); }); !done) {
                return done;
            }
            const auto grown = tree_.update(device_);
            if (!grown) {
                return failure(grown.error());
            }
            again = *grown;
        }
        return count();
    }

    [[nodiscard]] result<void> count() {
        const auto made = tree_.triangles(device_);
        if (!made) {
            return failure(made.error());
        }
        job_.triangles = *made;
        job_.indices = 3 * *made;
        job_.parts = 0;
        job_.vertices = 0;
        const auto add = [&](const buffer_view<B>& vertices, const draw_geometry<B>&) {
            ++job_.parts;
            job_.vertices += vertices.size / sizeof(surface_vertex);
        };
        tree_.for_each_wood(add);
        tree_.for_each_leaf(add);
        return {};
    }

    [[nodiscard]] result<void> draw(std::uint32_t frame) {
        job_.time.begin("draw");
        if (!painter_) {
            const picture::picture_options options = picture_of(job_);
            auto painter = picture::tree_painter<B>::create(device_, options, job_.maps);
            if (!painter) {
                return failure(painter.error());
            }
            painter_ = std::move(*painter);
        }
        std::vector<picture::drawable<B>> all;
        const auto wood =
            job_.surface == tree_surface::sticks ? picture::look::plain : picture::look::bark;
        tree_.for_each_wood([&](auto vertices, auto which) {
            all.push_back({vertices, which, wood});
        });
        tree_.for_each_leaf([&](auto vertices, auto which) {
            all.push_back({vertices, which, picture::look::leaf});
        });
        const float ground = std::clamp(0.0f, job_.low.y, job_.high.y);
        const auto scene = picture::scene_around(glm::vec3(job_.low.x, ground, job_.low.z),
                                                 job_.high, painter_->options());
        auto drawn = run(device_, [&](typename B::recorder& to) {
            painter_->record(to, scene, all, ground, 400 * (job_.high.y - job_.low.y));
        });
        if (!drawn) {
            return drawn;
        }
        const auto pixels = painter_->download(device_);
        if (!pixels) {
            return failure(pixels.error());
        }
        return write_picture(frame, *pixels);
    }

    [[nodiscard]] result<void> write_picture(std::uint32_t frame,
                                             std::span<const std::uint8_t> rgba) {
        job_.time.begin("write");
        return job_.kind == tree_output::picture ? files_.write(name_of(job_, frame), rgba)
                                                 : files_.add(rgba);
    }

    [[nodiscard]] result<void> save(std::uint32_t frame) {
        job_.time.begin("write");
        finished_tree made;
        if (auto done = take_wood(made.wood); !done) {
            return done;
        }
        auto leaves = tree_.leaves().download(device_);
        if (!leaves) {
            return failure(leaves.error());
        }
        made.leaves.mesh = std::move(*leaves);
        return write_mesh(job_, made, frame);
    }

    [[nodiscard]] result<void> take_wood(finished_surface& to) {
        const auto* bark = tree_.bark();
        auto wood = bark != nullptr ? bark->download(device_, tree_.branches())
                                    : tree_.branches().download(device_);
        if (!wood) {
            return failure(wood.error());
        }
        to.mesh = std::move(*wood);
        if (job_.mesh.form == trees::mesh_form::list || job_.surface == tree_surface::detailed) {
            remove_degenerate(to.mesh);
        }
        if (job_.surface == tree_surface::closed) {
            to.places = weld(to.mesh.vertices);
        }
        return {};
    }

    [[nodiscard]] result<void> keep_pose() {
        const std::size_t first = animation_poses_.size();
        animation_poses_.resize(first + job_.tree.size());
        return device_.download(*tree_.motion().poses().buffer, 0,
                                std::as_writable_bytes(std::span(animation_poses_).subspan(first)));
    }

    /// The mesh at rest, its joints, and what they do.
    [[nodiscard]] result<void> save_animation() {
        job_.time.begin("mesh");
        auto done = run(device_, [&](auto& to) {
            if constexpr (requires { tree_.branches().record(to); }) {
                tree_.branches().record(to);
            }
            tree_.leaves().record(to);
        });
        if (done) {
            done = count();
        }
        if (!done) {
            return done;
        }
        job_.time.begin("write");
        finished_tree made;
        made.poses = std::move(animation_poses_);
        auto wood = tree_.branches().download(device_);
        auto leaves = tree_.leaves().download(device_);
        if (!wood || !leaves) {
            return failure(!wood ? wood.error() : leaves.error());
        }
        made.wood.mesh = std::move(*wood);
        made.leaves.mesh = std::move(*leaves);
        if constexpr (requires { io::mesh_carriers<B>(device_, tree_.branches()); }) {
            auto carriers = io::mesh_carriers<B>(device_, tree_.branches());
            if (!carriers) {
                return failure(carriers.error());
            }
            made.wood.carriers = std::move(*carriers);
        }
        const std::size_t each =
            job_.leaves.empty() ? 0 : made.leaves.mesh.vertices.size() / job_.leaves.size();
        for (const leaf& l : job_.leaves) {
            made.leaves.carriers.insert(made.leaves.carriers.end(), each,
                                        io::vertex_carrier{l.carrier, l.carrier, 0});
        }
        return write_mesh(job_, made, 0);
    }

    B& device_;
    tree_job& job_;
    trees::swaying_tree<B, Mesh> tree_;
    std::optional<trees::wind_field<B>> air_;
    std::optional<picture::tree_painter<B>> painter_;
    frame_files files_;
    std::vector<segment_pose> animation_poses_;
    double now_ = 0;
};

/// The wind that the job asks for, if any.
[[nodiscard]] inline result<trees::gusts> gusts_of(const tree_job& job) {
    const auto table = [&](auto model) {
        model.speed = job.more.wind;
        model.from = job.more.wind_from;
        if constexpr (requires { model.turbulence; }) {
            model.turbulence.seed = job.common.seed;
        }
        return trees::tabulate(model);
    };
    switch (job.more.gusts) {
    case gust_kind::kaimal:
        return table(trees::kaimal_gusts{});
    case gust_kind::power_law:
        return table(trees::power_law_gusts{});
    default:
        return table(trees::steady_wind{});
    }
}

[[nodiscard]] inline trees::sway_model sway_model_of(sway_kind kind) {
    switch (kind) {
    case sway_kind::paper:
        return trees::sway_model::paper;
    case sway_kind::quasi_static:
        return trees::sway_model::quasi_static;
    default:
        return trees::sway_model::dynamic;
    }
}

/// What the job asks of a mesh.
template <class Options>
[[nodiscard]] Options mesh_options_of(const tree_job& job) {
    Options options;
    options.sides = job.mesh.sides;
    options.rings = job.mesh.rings;
    options.frame = job.mesh.frame;
    if constexpr (requires { options.policy; }) {
        options.policy = job.mesh.policy;
    }
    if constexpr (requires { options.form; }) {
        options.form = job.mesh.form;
    }
    return options;
}

template <backend B, class Mesh>
[[nodiscard]] typename trees::swaying_tree<B, Mesh>::options_type options_of(const tree_job& job) {
    typename trees::swaying_tree<B, Mesh>::options_type options;
    options.branches = mesh_options_of<decltype(options.branches)>(job);
    const bool animated = job.kind == tree_output::glb && job.more.frames > 1;
    if (job.more.bark_depth > 0 && !animated) {
        options.bark = trees::bark_options{};
        options.bark->relief = job.more.bark_depth;
        options.bark->threshold = job.more.bark_edge;
        options.bark->thickness = 0.15f;
        options.bark->repeats_around = static_cast<std::uint32_t>(job.maps.bark_around);
        options.bark->repeats_per_metre = job.maps.bark_along;
        options.bark->policy = job.mesh.policy;
    }
    options.leaf_cover = static_cast<float>(job.leaf_picture.cover());
    options.sway.model = sway_model_of(job.more.sway);
    if (job.more.lod > 0) {
        options.view = picture::view_of(job.low, job.high, picture_of(job));
        options.view.error *= job.more.lod;
        options.view.thin *= job.more.lod;
        options.leaves.form = trees::mesh_form::list;
    }
    return options;
}

/// The branches as the job wants them.
template <backend B, class Mesh>
[[nodiscard]] result<Mesh> branches_of(B& device, const tree_job& job) {
    if constexpr (std::same_as<Mesh, trees::branch_mesh<B>>) {
        if (job.surface == tree_surface::sticks) {
            // As thin as a pencil's line; what lies on the ground has no height.
            const float height = trees::height(job.tree);
            const float size = height > 0 ? height : glm::distance(job.low, job.high);
            return Mesh::create(device, skeleton_layout(job.tree, 0.0012f * size), job.mesh);
        }
    }
    return Mesh::create(device, job.tree, options_of<B, Mesh>(job).branches);
}

template <backend B, class Mesh>
[[nodiscard]] result<void> make_frames(B& device, tree_job& job) {
    job.time.begin("build");
    std::optional<trees::wind_field<B>> air;
    if (job.more.wind > 0) {
        const auto table = gusts_of(job);
        if (!table) {
            return failure(table.error());
        }
        auto made = trees::wind_field<B>::create(device, trees::segment_middles(job.tree), *table);
        if (!made) {
            return failure(made.error());
        }
        air = std::move(*made);
    }
    auto branches = branches_of<B, Mesh>(device, job);
    if (!branches) {
        return failure(branches.error());
    }
    auto tree = trees::swaying_tree<B, Mesh>::create(
        device, job.tree, std::move(*branches), job.leaves, job.bark, options_of<B, Mesh>(job));
    if (!tree) {
        return failure(tree.error());
    }
    return tree_frames<B, Mesh>(device, job, std::move(*tree), std::move(air)).make();
}

/// Reads, sways, meshes, and draws or saves. `driver` is what the report says of it.
template <backend B>
[[nodiscard]] result<void> make_tree(B& device, tree_job& job, std::string driver) {
    job.device = device.device_name();
    job.driver = std::move(driver);
    if (auto done = read_skeleton(job); !done) {
        return done;
    }
    if (auto done = dress(job); !done) {
        return done;
    }
    result<void> done;
    switch (job.surface) {
    case tree_surface::closed:
        done = make_frames<B, trees::closed_mesh<B>>(device, job);
        break;
    case tree_surface::detailed:
        done = make_frames<B, trees::detailed_branch_mesh<B>>(device, job);
        break;
    default:
        done = make_frames<B, trees::branch_mesh<B>>(device, job);
        break;
    }
    job.time.end();
    job.traffic = device.traffic();
    return done;
}

} // namespace skybark::tool
