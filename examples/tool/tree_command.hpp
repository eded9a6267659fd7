#pragma once
// The tree command on a device of any backend.

#include "tree_job.hpp"

#include <picture/tree_picture.hpp>

namespace skybark::tool {

template <backend B>
[[nodiscard]] result<void> draw_picture(B& device, const trees::branch_mesh<B>& mesh,
                                        tree_job& job) {
    picture::picture_options options;
    options.width = job.common.width;
    options.height = job.common.height;
    options.skeleton = job.skeleton;
    job.time.begin("draw");
    const auto pixels = picture::draw_tree<B>(device, mesh, job.low, job.high, options);
    if (!pixels) {
        return failure(pixels.error());
    }
    job.time.begin("write");
    return write_picture(job, *pixels);
}

template <backend B>
[[nodiscard]] result<void> save_mesh(B& device, const trees::branch_mesh<B>& mesh, tree_job& job) {
    job.time.begin("write");
    auto downloaded = mesh.download(device);
    if (!downloaded) {
        return failure(downloaded.error());
    }
    if (job.mesh.form == trees::mesh_form::list && job.mesh.policy == padding::degenerate) {
        remove_degenerate(*downloaded);
    }
    return write_mesh(job, *downloaded);
}

/// Reads, meshes, and draws or saves. `driver` is what the report says of it.
template <backend B>
[[nodiscard]] result<void> make_tree(B& device, tree_job& job, std::string driver) {
    job.device = device.device_name();
    job.driver = std::move(driver);
    if (auto done = read_layout(job); !done) {
        return done;
    }
    job.time.begin("mesh");
    auto mesh = trees::branch_mesh<B>::create(device, job.layout, job.mesh);
    if (!mesh) {
        return failure(mesh.error());
    }
    if (auto done = run(device, [&](auto& recorder) { mesh->record(recorder); }); !done) {
        return done;
    }
    job.vertices = mesh->vertices();
    job.triangles = mesh->triangles();
    job.indices = 3 * job.triangles;
    job.parts = mesh->parts().size();
    auto done = job.kind == tree_output::picture ? draw_picture(device, *mesh, job)
                                                 : save_mesh(device, *mesh, job);
    job.time.end();
    job.traffic = device.traffic();
    return done;
}

} // namespace skybark::tool
