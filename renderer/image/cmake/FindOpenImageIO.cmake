# Finds OpenImageIO by its headers and libraries alone. Debian's own CMake package
# (libopenimageio-dev 2.4) names programs of openimageio-tools among its targets
# and fails when they are not installed.
#
# Defines the imported target OpenImageIO::OpenImageIO.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h)
find_library(OpenImageIO_LIBRARY OpenImageIO)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util)

if(OpenImageIO_INCLUDE_DIR AND EXISTS "${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h")
  file(STRINGS "${OpenImageIO_INCLUDE_DIR}/OpenImageIO/oiioversion.h" _version_lines
       REGEX "#define OIIO_VERSION_(MAJOR|MINOR|PATCH) +[0-9]+")
  set(_parts "")
  foreach(_line IN LISTS _version_lines)
    string(REGEX REPLACE "[^0-9]" "" _number "${_line}")
    list(APPEND _parts "${_number}")
  endforeach()
  list(JOIN _parts "." OpenImageIO_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenImageIO
  REQUIRED_VARS OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY OpenImageIO_INCLUDE_DIR
  VERSION_VAR OpenImageIO_VERSION)

if(OpenImageIO_FOUND AND NOT TARGET OpenImageIO::OpenImageIO)
  add_library(OpenImageIO::Util UNKNOWN IMPORTED GLOBAL)
  set_target_properties(OpenImageIO::Util PROPERTIES
    IMPORTED_LOCATION "${OpenImageIO_Util_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR}")
  add_library(OpenImageIO::OpenImageIO UNKNOWN IMPORTED GLOBAL)
  set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
    IMPORTED_LOCATION "${OpenImageIO_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES OpenImageIO::Util)
endif()
mark_as_advanced(OpenImageIO_INCLUDE_DIR OpenImageIO_LIBRARY OpenImageIO_Util_LIBRARY)
