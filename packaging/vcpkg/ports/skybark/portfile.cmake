# Written from vcpkg's documentation; not run by the tests of this repository.
#
# An overlay port: the sources are those of the checkout that this file lies in.
#   vcpkg install skybark --overlay-ports=packaging/vcpkg/ports

set(VCPKG_BUILD_TYPE release) # headers only: a debug build would install the same files
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../../.." ABSOLUTE)

vcpkg_cmake_configure(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS
        -DSKYBARK_BUILD_TESTS=OFF
        -DSKYBARK_BUILD_EXAMPLES=OFF
        -DSKYBARK_BUILD_BENCHMARKS=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME skybark CONFIG_PATH share/cmake/skybark)
vcpkg_fixup_pkgconfig()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/share/cmake")

file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
