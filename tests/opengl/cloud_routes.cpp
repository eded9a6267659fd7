// Clouds' shadow polygons on OpenGL: that they are drawn as the paper says, each way by its own
// functions, and how many primitives the stages make. That all ways give the same bits is tested
// with the volumes; from the bits alone nobody could tell the ways apart.

#include "caller.hpp"
#include "support/cloud_sums.hpp"

#include <skybark/clouds/attenuation_volume.hpp>

#include <set>

namespace skybark::opengl::tests {
namespace {

using namespace skybark::clouds;

/// What a frame asks OpenGL for.
struct drawn_calls {
    std::size_t triangles = 0; ///< vertices, of draws of more than one triangle
    std::size_t points = 0;
    std::size_t tiles = 0;           ///< draws of one triangle
    std::size_t indirect_points = 0; ///< draws of points whose number only the device knows
    std::size_t copies = 0;          ///< from a framebuffer into a 3-D texture
    std::set<GLint> layers;          ///< that were attached to a framebuffer
};

/// Counts them; OpenGL's own functions know nothing of it.
struct counted_drawing {
    inline static drawn_calls now;
    inline static PFNGLDRAWARRAYSPROC draw = nullptr;
    inline static PFNGLDRAWARRAYSINDIRECTPROC indirect = nullptr;
    inline static PFNGLCOPYTEXTURESUBIMAGE3DPROC copy = nullptr;
    inline static PFNGLNAMEDFRAMEBUFFERTEXTURELAYERPROC layer = nullptr;

    static void APIENTRY draw_arrays(GLenum mode, GLint first, GLsizei count) {
        if (mode == GL_POINTS) {
            now.points += static_cast<std::size_t>(count);
        } else if (count == 3) {
            ++now.tiles;
        } else {
            now.triangles += static_cast<std::size_t>(count);
        }
        draw(mode, first, count);
    }
    static void APIENTRY draw_indirect(GLenum mode, const void* at) {
        now.indirect_points += mode == GL_POINTS ? 1 : 0;
        indirect(mode, at);
    }
    static void APIENTRY copy_tile(GLuint texture, GLint level, GLint x, GLint y, GLint z,
                                   GLint from_x, GLint from_y, GLsizei width, GLsizei height) {
        ++now.copies;
        copy(texture, level, x, y, z, from_x, from_y, width, height);
    }
    static void APIENTRY attach_layer(GLuint frame, GLenum attachment, GLuint texture, GLint level,
                                      GLint number) {
        now.layers.insert(number);
        layer(frame, attachment, texture, level, number);
    }
    static procedure find(const char* name, void* user) {
        const procedure found = static_cast<caller_context*>(user)->find(name);
        const auto instead = [&](auto& kept, auto counting) {
            kept = reinterpret_cast<std::remove_reference_t<decltype(kept)>>(found);
            return reinterpret_cast<procedure>(counting);
        };
        const std::string_view text(name);
        return text == "glDrawArrays"                     ? instead(draw, &draw_arrays)
               : text == "glDrawArraysIndirect"           ? instead(indirect, &draw_indirect)
               : text == "glCopyTextureSubImage3D"        ? instead(copy, &copy_tile)
               : text == "glNamedFramebufferTextureLayer" ? instead(layer, &attach_layer)
                                                          : found;
    }
};

class cloud_routes : public testing::Test {
  protected:
    void SetUp() override {
        if (!caller.current()) {
            ASSERT_FALSE(required());
            GTEST_SKIP() << "There is no EGL with OpenGL 4.5.";
        }
        description described = caller.describe();
        described.get_proc_address = &counted_drawing::find;
        auto made = gpu::create(std::move(described));
        ASSERT_TRUE(made) << made.error().message;
        device.emplace(std::move(*made));
        box = *fit_light_box(particles, {0.4f, 0.7f, -0.3f}, voxels);
    }
    template <class Function>
    [[nodiscard]] Function gl(const char* name) const {
        return reinterpret_cast<Function>(caller.find(name));
    }

    /// One frame; what it drew is in counted_drawing. Primitives that reach the rasteriser are
    /// counted by the driver where polygons come from the stages.
    GLuint frame(polygon_source polygons, accumulate_route route, padding policy) {
        attenuation_options how =
            support::with(attenuation_method::shadow_polygons, attenuation_profile::step);
        how.polygons = polygons;
        how.route = route;
        how.policy = policy;
        auto volume = attenuation_volume<gpu>::create(*device, voxels, how);
        const auto buffer = make_buffer<gpu, cloud_particle>(*device, particles);
        if (!volume || !buffer) {
            ADD_FAILURE() << "no volume";
            return 0;
        }
        counted_drawing::now = {};
        GLuint query = 0;
        gl<PFNGLGENQUERIESPROC>("glGenQueries")(1, &query);
        // Lists are made under a query of the backend's own.
        const bool counts = polygons == polygon_source::stage;
        if (counts) {
            gl<PFNGLBEGINQUERYPROC>("glBeginQuery")(GL_PRIMITIVES_GENERATED, query);
        }
        const auto done =
            run(*device, [&](recorder& r) { volume->relight(r, view<gpu>(*buffer), count, box); });
        EXPECT_TRUE(done) << (done ? "" : done.error().message);
        GLuint primitives = 0;
        if (counts) {
            gl<PFNGLENDQUERYPROC>("glEndQuery")(GL_PRIMITIVES_GENERATED);
            gl<PFNGLGETQUERYOBJECTUIVPROC>("glGetQueryObjectuiv")(query, GL_QUERY_RESULT,
                                                                  &primitives);
        }
        gl<PFNGLDELETEQUERIESPROC>("glDeleteQueries")(1, &query);
        return primitives;
    }

    /// Layers whose middles lie in the particles, from the definition of the grid: Σ n_p.
    [[nodiscard]] std::size_t slices() const {
        std::size_t sum = 0;
        for (const cloud_particle& p : particles) {
            const glm::dvec3 from = glm::dvec3(p.position) - glm::dvec3(glm::vec3(box.grid.anchor));
            const double centre =
                glm::dot(glm::dvec3(glm::vec3(box.grid.row_z)), from) + double(box.grid.row_z.w);
            const double reach = double(p.radius) / double(box.grid.voxel.z);
            for (std::uint32_t z = 0; z < voxels.z; ++z) {
                sum += std::abs(z + 0.5 - centre) < reach ? 1 : 0;
            }
        }
        return sum;
    }
    [[nodiscard]] std::size_t most_slices() const {
        return count * std::size_t{attenuation_volume<gpu>::shade_of({}, box).slices};
    }

    static constexpr std::uint32_t count = 64;
    const glm::uvec3 voxels{24, 20, 28};
    const std::vector<cloud_particle> particles = support::ball(count, 0.1f, 0.3f, 0.5f, 31);
    light_box box;
    caller_context caller;
    std::optional<gpu> device;
};

// Section 4.1 of the paper: every particle has n_pmax rectangles, n_pmax - n_p of them degenerate;
// its future work: a geometry stage that makes n_p, and layered rendering.
TEST_F(cloud_routes, stages_make_as_many_rectangles_as_the_padding_says) {
    const std::size_t padded = 2 * most_slices();
    const std::size_t compact = 2 * slices();
    ASSERT_GT(padded, compact + 2 * count);
    for (const auto route : {accumulate_route::tiles_copied, accumulate_route::tiles_drawn,
                             accumulate_route::layers}) {
        // Tiles are drawn into the layers by a triangle each.
        const std::size_t tiles = route == accumulate_route::tiles_drawn ? voxels.z : 0;
        const auto which = static_cast<int>(route);
        const GLuint all = frame(polygon_source::stage, route, padding::degenerate);
        EXPECT_EQ(all, padded + tiles) << which;
        if (route == accumulate_route::layers) { // only a geometry stage can choose a layer
            EXPECT_EQ(counted_drawing::now.triangles, 0u);
            EXPECT_GT(counted_drawing::now.points, 0u);
        } else { // by the vertex stage, out of nothing but a number
            EXPECT_EQ(counted_drawing::now.triangles, 3 * padded) << which;
            EXPECT_EQ(counted_drawing::now.points, 0u) << which;
        }
        const GLuint some = frame(polygon_source::stage, route, padding::compact);
        EXPECT_EQ(some, compact + tiles) << which;
        EXPECT_EQ(counted_drawing::now.triangles, 0u) << which;
        EXPECT_GE(counted_drawing::now.points, count) << which;
        EXPECT_LT(counted_drawing::now.points, 2 * count) << which;
    }
    EXPECT_EQ(frame(polygon_source::stage, accumulate_route::direct, padding::compact), 0u);
}

// Section 4.3: from the tiles into the 3-D texture by a copy of the framebuffer, or by drawing into
// its layers; or into its layers at once.
TEST_F(cloud_routes, each_route_is_its_own) {
    for (const auto polygons : {polygon_source::stage, polygon_source::list}) {
        for (const padding policy : {padding::degenerate, padding::compact}) {
            frame(polygons, accumulate_route::tiles_copied, policy);
            EXPECT_EQ(counted_drawing::now.copies, voxels.z);
            EXPECT_EQ(counted_drawing::now.tiles, 0u);
            EXPECT_TRUE(counted_drawing::now.layers.empty());

            frame(polygons, accumulate_route::tiles_drawn, policy);
            EXPECT_EQ(counted_drawing::now.copies, 0u);
            EXPECT_EQ(counted_drawing::now.tiles, voxels.z);
            EXPECT_EQ(counted_drawing::now.layers.size(), voxels.z);

            frame(polygons, accumulate_route::layers, policy);
            EXPECT_EQ(counted_drawing::now.copies, 0u);
            EXPECT_EQ(counted_drawing::now.tiles, 0u);
            EXPECT_TRUE(counted_drawing::now.layers.empty());
            EXPECT_GT(counted_drawing::now.points + counted_drawing::now.indirect_points, 0u);
        }
    }
    frame(polygon_source::stage, accumulate_route::direct, padding::compact);
    EXPECT_EQ(counted_drawing::now.points + counted_drawing::now.triangles, 0u);
}

} // namespace
} // namespace skybark::opengl::tests
