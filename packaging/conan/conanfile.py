# Written from the documentation of Conan 2; not run by the tests of this repository.
#
# Takes the sources from the checkout that this file lies in:
#   conan create packaging/conan --build=missing -s compiler.cppstd=20

import re
from pathlib import Path

from conan import ConanFile
from conan.tools.build import check_min_cppstd
from conan.tools.files import copy


class Skybark(ConanFile):
    name = "skybark"
    description = "GPU algorithms for natural scenes: trees, clouds, gathered light"
    license = "MIT"
    topics = ("graphics", "vulkan", "opengl", "header-only")
    package_type = "header-library"
    settings = "os", "arch", "compiler", "build_type"
    options = {"with_vulkan": [True, False]}
    default_options = {"with_vulkan": True}
    no_copy_source = True

    def set_version(self):
        text = (Path(self.recipe_folder) / "../../CMakeLists.txt").read_text()
        self.version = re.search(r"project\(skybark VERSION ([\d.]+)", text)[1]

    def export_sources(self):
        root = str(Path(self.recipe_folder).parents[1])
        for pattern in ("include/*", "backends/*", "LICENSE"):
            copy(self, pattern, root, self.export_sources_folder)

    def requirements(self):
        self.requires("glm/0.9.9.8", transitive_headers=True)
        self.requires("tl-expected/1.1.0", transitive_headers=True)
        if self.options.with_vulkan:
            self.requires("vulkan-headers/[>=1.3.204 <2]", transitive_headers=True)

    def validate(self):
        check_min_cppstd(self, 20)

    def package_id(self):
        self.info.clear() # the same headers for everybody

    def package(self):
        copy(self, "LICENSE", self.source_folder, str(Path(self.package_folder) / "licenses"))
        for root in ("include", "backends"): # the two become one
            for pattern in ("*.hpp", "*.glsl"):
                copy(self, pattern, str(Path(self.source_folder) / root),
                     str(Path(self.package_folder) / "include"))

    def package_info(self):
        self.cpp_info.set_property("cmake_file_name", "skybark")
        unix = self.settings.os in ("Linux", "FreeBSD")
        self._component("skybark", ["glm::glm", "tl-expected::tl-expected"])
        self._component("cpu", ["skybark"], ["pthread"] if unix else [])
        self._component("opengl", ["skybark"], ["dl"] if unix else [])
        if self.options.with_vulkan:
            self._component("vulkan", ["skybark", "vulkan-headers::vulkanheaders"],
                            ["dl"] if unix else [])

    def _component(self, name, requires, system_libs=()):
        component = self.cpp_info.components[name]
        component.set_property("cmake_target_name", f"skybark::{name}")
        component.requires = requires
        component.system_libs = list(system_libs)
        component.bindirs = []
        component.libdirs = []
