// The paper's ways of drawing an attenuation volume, told apart by what OpenGL is asked to do. All
// routes have the same sums, so that one that took another's place would not show in them: here the
// calls that make them are counted, with the triangles and the fragments that they come to and the
// blending that adds those up (Shimada et al. 2008, 3.3, 4.1 and 4.3).

#include "caller.hpp"

#include <skybark/clouds/attenuation_volume.hpp>

#include <random>

namespace skybark::opengl::tests {
namespace {

using namespace skybark::clouds;

/// A call that draws.
struct drawn {
    GLenum primitive = 0;
    bool has_geometry_stage = false;
    bool into_layers = false; ///< of a 3-D texture, all at once
    GLuint triangles = 0;     ///< that reach the rasteriser, degenerate ones among them
    GLuint fragments = 0;
    bool blends = false;
    GLenum equation = 0; ///< of the first component, and its factors
    GLenum source = 0;
    GLenum destination = 0;
};

/// OpenGL's functions, with notes of what goes through them.
struct noted_calls {
    inline static caller_context* context = nullptr;
    inline static std::vector<drawn> draws;
    inline static std::vector<GLint> copied_into;   ///< layers, by glCopyTextureSubImage3D
    inline static std::vector<GLint> attached_last; ///< single layers of framebuffers

    template <class Function>
    [[nodiscard]] static Function gl(const char* name) {
        return reinterpret_cast<Function>(context->find(name));
    }
    [[nodiscard]] static GLint integer(GLenum name) {
        GLint value = 0;
        gl<PFNGLGETINTEGERVPROC>("glGetIntegerv")(name, &value);
        return value;
    }
    [[nodiscard]] static bool geometry_stage() {
        GLuint shaders[8] = {};
        GLsizei count = 0;
        gl<PFNGLGETATTACHEDSHADERSPROC>("glGetAttachedShaders")(
            static_cast<GLuint>(integer(GL_CURRENT_PROGRAM)), 8, &count, shaders);
        for (GLsizei i = 0; i < count; ++i) {
            GLint type = 0;
            gl<PFNGLGETSHADERIVPROC>("glGetShaderiv")(shaders[i], GL_SHADER_TYPE, &type);
            if (type == GL_GEOMETRY_SHADER) {
                return true;
            }
        }
        return false;
    }
    [[nodiscard]] static bool layered_target() {
        GLint layered = 0;
        gl<PFNGLGETNAMEDFRAMEBUFFERATTACHMENTPARAMETERIVPROC>(
            "glGetNamedFramebufferAttachmentParameteriv")(
            static_cast<GLuint>(integer(GL_DRAW_FRAMEBUFFER_BINDING)), GL_COLOR_ATTACHMENT0,
            GL_FRAMEBUFFER_ATTACHMENT_LAYERED, &layered);
        return layered != 0;
    }
    /// Draws, and asks what has come of it: not where `expand` makes its list, which is never seen.
    template <class Draw>
    static void note(GLenum primitive, Draw&& draw) {
        if (gl<PFNGLISENABLEDPROC>("glIsEnabled")(GL_RASTERIZER_DISCARD) != 0) {
            return draw();
        }
        const GLenum targets[] = {GL_PRIMITIVES_GENERATED, GL_SAMPLES_PASSED};
        GLuint queries[2] = {};
        gl<PFNGLGENQUERIESPROC>("glGenQueries")(2, queries);
        for (int i = 0; i < 2; ++i) {
            gl<PFNGLBEGINQUERYPROC>("glBeginQuery")(targets[i], queries[i]);
        }
        // As the call finds it.
        const bool blends = gl<PFNGLISENABLEDPROC>("glIsEnabled")(GL_BLEND) != 0;
        const auto equation = static_cast<GLenum>(integer(GL_BLEND_EQUATION_RGB));
        const auto source = static_cast<GLenum>(integer(GL_BLEND_SRC_RGB));
        const auto destination = static_cast<GLenum>(integer(GL_BLEND_DST_RGB));
        draw();
        GLuint counts[2] = {};
        for (int i = 0; i < 2; ++i) {
            gl<PFNGLENDQUERYPROC>("glEndQuery")(targets[i]);
            gl<PFNGLGETQUERYOBJECTUIVPROC>("glGetQueryObjectuiv")(queries[i], GL_QUERY_RESULT,
                                                                  &counts[i]);
        }
        gl<PFNGLDELETEQUERIESPROC>("glDeleteQueries")(2, queries);
        draws.push_back({primitive, geometry_stage(), layered_target(), counts[0], counts[1],
                         blends, equation, source, destination});
    }

    static void APIENTRY draw_arrays(GLenum mode, GLint first, GLsizei count) {
        note(mode, [=] { gl<PFNGLDRAWARRAYSPROC>("glDrawArrays")(mode, first, count); });
    }
    static void APIENTRY draw_indirect(GLenum mode, const void* arguments) {
        note(mode,
             [=] { gl<PFNGLDRAWARRAYSINDIRECTPROC>("glDrawArraysIndirect")(mode, arguments); });
    }
    static void APIENTRY copy(GLuint texture, GLint level, GLint x, GLint y, GLint layer,
                              GLint from_x, GLint from_y, GLsizei width, GLsizei height) {
        copied_into.push_back(layer);
        gl<PFNGLCOPYTEXTURESUBIMAGE3DPROC>("glCopyTextureSubImage3D")(
            texture, level, x, y, layer, from_x, from_y, width, height);
    }
    static void APIENTRY attach_layer(GLuint framebuffer, GLenum attachment, GLuint texture,
                                      GLint level, GLint layer) {
        attached_last.push_back(layer);
        gl<PFNGLNAMEDFRAMEBUFFERTEXTURELAYERPROC>("glNamedFramebufferTextureLayer")(
            framebuffer, attachment, texture, level, layer);
    }
    static procedure find(const char* name, void* user) {
        context = static_cast<caller_context*>(user);
        const std::string_view text(name);
        return text == "glDrawArrays"              ? reinterpret_cast<procedure>(&draw_arrays)
               : text == "glDrawArraysIndirect"    ? reinterpret_cast<procedure>(&draw_indirect)
               : text == "glCopyTextureSubImage3D" ? reinterpret_cast<procedure>(&copy)
               : text == "glNamedFramebufferTextureLayer"
                   ? reinterpret_cast<procedure>(&attach_layer)
                   : context->find(name);
    }
    static void forget() {
        draws.clear();
        copied_into.clear();
        attached_last.clear();
    }
};

constexpr glm::uvec3 voxels{29, 31, 26};
constexpr glm::vec3 to_sun{0.4f, 0.7f, -0.3f};

/// Particles of sizes from one layer's to a third of the box.
std::vector<cloud_particle> some_particles() {
    std::vector<cloud_particle> particles;
    std::mt19937 random(4);
    std::uniform_real_distribution<float> number(0, 1);
    for (int i = 0; i < 70; ++i) {
        const float size = number(random);
        particles.push_back({{100 * number(random), 60 * number(random), 80 * number(random)},
                             1.5f + 25 * size * size,
                             0.5f,
                             0.9f,
                             {0, 0}});
    }
    return particles;
}

/// What the paper says of a cloud's rectangles, from the grid's definition in double precision.
struct counted_rectangles {
    std::uint64_t most = 0;  ///< n_pmax · N
    std::uint64_t has = 0;   ///< Σ n_p
    std::uint64_t cells = 0; ///< voxels in all of them, which are the fragments that are drawn
};

/// Numbers k of cells whose middle k + ½ lies within `reach` of `centre`.
std::uint64_t middles_within(double centre, double reach) {
    std::uint64_t count = 0;
    for (int k = 0; k < 40; ++k) {
        count += std::abs(k + 0.5 - centre) < reach ? 1 : 0;
    }
    return count;
}

counted_rectangles count_rectangles(std::span<const cloud_particle> particles,
                                    const light_box& box) {
    counted_rectangles found;
    const light_grid& g = box.grid;
    for (const cloud_particle& p : particles) {
        const glm::dvec3 from = glm::dvec3(p.position) - glm::dvec3(glm::vec3(g.anchor));
        const auto cell = [&](const glm::vec4& row) {
            return glm::dot(glm::dvec3(glm::vec3(row)), from) + double(row.w);
        };
        const glm::dvec3 reach = double(p.radius) / glm::dvec3(glm::vec3(g.voxel));
        std::uint64_t rows = 0; // from the bottom to a radius above the centre
        for (std::uint32_t y = 0; y < voxels.y; ++y) {
            rows += y + 0.5 < cell(g.row_y) + reach.y ? 1 : 0;
        }
        const std::uint64_t layers = middles_within(cell(g.row_z), reach.z);
        const std::uint64_t columns = middles_within(cell(g.row_x), reach.x);
        found.has +=
            columns != 0 ? layers : 0; // between the middles of two columns there is nothing
        found.cells += layers * rows * columns;
    }
    return found;
}

class drawn_routes : public testing::TestWithParam<std::tuple<accumulate_route, padding>> {
  protected:
    void SetUp() override {
        if (!caller.current()) {
            ASSERT_FALSE(required());
            GTEST_SKIP() << "There is no EGL with OpenGL 4.5.";
        }
        description described = caller.describe();
        described.get_proc_address = &noted_calls::find;
        auto made = gpu::create(std::move(described));
        ASSERT_TRUE(made) << made.error().message;
        device.emplace(std::move(*made));
    }
    [[nodiscard]] static accumulate_route route() { return std::get<0>(GetParam()); }
    [[nodiscard]] static bool padded() { return std::get<1>(GetParam()) == padding::degenerate; }
    [[nodiscard]] static bool tiled() { return route() != accumulate_route::layers; }

    /// Relights with rectangles from there, and returns what they should come to.
    [[nodiscard]] counted_rectangles relight(polygon_source polygons) {
        const auto particles = some_particles();
        const auto box = fit_light_box(particles, to_sun, voxels);
        attenuation_options options;
        options.method = attenuation_method::shadow_polygons;
        options.polygons = polygons;
        options.route = route();
        options.policy = std::get<1>(GetParam());
        auto volume = attenuation_volume<gpu>::create(*device, voxels, options);
        auto buffer = make_buffer<gpu, cloud_particle>(*device, particles);
        EXPECT_TRUE(box && volume && buffer);
        if (!box || !volume || !buffer) {
            return {};
        }
        noted_calls::forget();
        EXPECT_TRUE(run(*device, [&](recorder& r) {
            volume->relight(r, view<gpu>(*buffer), static_cast<std::uint32_t>(particles.size()),
                            *box);
        }));
        counted_rectangles expected = count_rectangles(particles, *box);
        expected.most =
            particles.size() * kernels::shadow_slab{volume->shade_of(options, *box)}.slabs();
        EXPECT_GT(expected.most, expected.has);
        return expected;
    }

    caller_context caller;
    std::optional<gpu> device;
};

std::vector<GLint> each_layer() {
    std::vector<GLint> layers(voxels.z);
    for (std::size_t i = 0; i < layers.size(); ++i) {
        layers[i] = static_cast<GLint>(i);
    }
    return layers;
}

std::string way_name(const testing::TestParamInfo<drawn_routes::ParamType>& way) {
    const char* routes[] = {"direct", "tiles_copied", "tiles_drawn", "layers"};
    return std::string(routes[static_cast<std::size_t>(std::get<0>(way.param))]) +
           (std::get<1>(way.param) == padding::compact ? "_compact" : "_degenerate");
}

} // namespace

// The draw of all rectangles is the first one.
TEST_P(drawn_routes, draws_as_many_triangles_as_the_paper_says) {
    const counted_rectangles expected = relight(polygon_source::stage);
    ASSERT_FALSE(noted_calls::draws.empty());
    const drawn& rectangles = noted_calls::draws.front();
    EXPECT_EQ(rectangles.triangles, 2 * (padded() ? expected.most : expected.has));
    EXPECT_EQ(rectangles.fragments, expected.cells);
    // Padded in the vertex stage as the paper did; compact, and where a layer is to be chosen, in
    // the geometry stage.
    EXPECT_EQ(rectangles.has_geometry_stage, !padded() || !tiled());
    EXPECT_EQ(rectangles.primitive,
              GLenum(rectangles.has_geometry_stage ? GL_POINTS : GL_TRIANGLES));
    EXPECT_EQ(rectangles.into_layers, !tiled());
}

// The paper has the blending unit add up a voxel's rectangles: whatever draws more than a tile's
// one triangle adds to what is there, and a tile takes its place in the layer as it is.
TEST_P(drawn_routes, adds_rectangles_up_by_blending) {
    for (const polygon_source polygons : {polygon_source::stage, polygon_source::list}) {
        (void)relight(polygons);
        std::size_t additions = 0;
        for (const drawn& each : noted_calls::draws) {
            if (each.triangles > 1) {
                EXPECT_TRUE(each.blends);
                EXPECT_EQ(each.equation, GLenum(GL_FUNC_ADD));
                EXPECT_EQ(each.source, GLenum(GL_ONE));
                EXPECT_EQ(each.destination, GLenum(GL_ONE));
                ++additions;
            } else {
                EXPECT_FALSE(each.blends);
            }
        }
        EXPECT_EQ(additions, 1u);
    }
}

// Of the list each triangle is an element with room for one rectangle, which every second one has.
TEST_P(drawn_routes, draws_as_many_triangles_of_a_list) {
    const counted_rectangles expected = relight(polygon_source::list);
    GLuint triangles = 0;
    GLuint fragments = 0;
    for (const drawn& each : noted_calls::draws) {
        if (each.primitive == GLenum(padded() && tiled() ? GL_TRIANGLES : GL_POINTS) &&
            each.triangles > 1) { // one is that of a tile
            triangles += each.triangles;
            fragments += each.fragments;
            EXPECT_EQ(each.into_layers, !tiled());
        }
    }
    EXPECT_EQ(triangles, padded() ? 4 * expected.most : 2 * expected.has);
    EXPECT_EQ(fragments, expected.cells);
}

TEST_P(drawn_routes, fills_the_volume_its_own_way) {
    for (const polygon_source polygons : {polygon_source::stage, polygon_source::list}) {
        (void)relight(polygons);
        const std::vector<GLint> none;
        EXPECT_EQ(noted_calls::copied_into,
                  route() == accumulate_route::tiles_copied ? each_layer() : none);
        EXPECT_EQ(noted_calls::attached_last,
                  route() == accumulate_route::tiles_drawn ? each_layer() : none);
        const auto& draws = noted_calls::draws;
        ASSERT_EQ(draws.size(), route() == accumulate_route::tiles_drawn ? 1 + voxels.z : 1u);
        for (std::size_t i = 1; i < draws.size(); ++i) {
            // A triangle that covers the layer: a fragment a voxel.
            EXPECT_EQ(draws[i].triangles, 1u);
            EXPECT_EQ(draws[i].fragments, voxels.x * voxels.y);
            EXPECT_FALSE(draws[i].has_geometry_stage);
            EXPECT_FALSE(draws[i].into_layers);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(all, drawn_routes,
                         testing::Combine(testing::Values(accumulate_route::tiles_copied,
                                                          accumulate_route::tiles_drawn,
                                                          accumulate_route::layers),
                                          testing::Values(padding::degenerate, padding::compact)),
                         way_name);

class undrawn_route : public drawn_routes {};

// Neither the atomic additions nor the impulses draw anything.
TEST_P(undrawn_route, draws_nothing) {
    (void)relight(polygon_source::stage);
    EXPECT_TRUE(noted_calls::draws.empty());
    EXPECT_TRUE(noted_calls::copied_into.empty());
    EXPECT_TRUE(noted_calls::attached_last.empty());
}

INSTANTIATE_TEST_SUITE_P(all, undrawn_route,
                         testing::Combine(testing::Values(accumulate_route::direct),
                                          testing::Values(padding::degenerate, padding::compact)),
                         way_name);

} // namespace skybark::opengl::tests
