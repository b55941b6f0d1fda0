# The port of vcpkg: the library alone.
vcpkg_download_distfile(ARCHIVE
    URLS "@URL@"
    FILENAME "gscl-${VERSION}.tar.xz"
    SHA512 @SHA512@
)
vcpkg_extract_source_archive(SOURCE_PATH ARCHIVE "${ARCHIVE}")

# Kernels of the processor need clang, which a port cannot require; OpenCL is opened where there is one.
vcpkg_configure_meson(
    SOURCE_PATH "${SOURCE_PATH}"
    OPTIONS
        -Dtool=disabled
        -Dtests=disabled
)
vcpkg_install_meson()
vcpkg_fixup_pkgconfig()
if(EXISTS "${CURRENT_PACKAGES_DIR}/lib/cmake/gscl")
    vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/gscl)
endif()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
