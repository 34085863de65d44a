# Included right after project() when pip builds this package (CMAKE_PROJECT_INCLUDE in pyproject.toml).
# It bridges what ROS from Python wheels does differently from an installed ROS, so that CMakeLists.txt can
# stay as a ROS user expects it. colcon reads it only when told to.

# The wheels put their CMake packages at an environment's prefix, not on any search path. With build
# isolation there is more than one prefix, so each place Python imports from is tried.
execute_process(
  COMMAND "${Python3_EXECUTABLE}" -c "import sys; print(';'.join(p for p in sys.path if p.endswith('-packages')))"
  OUTPUT_VARIABLE hgma_site_packages
  OUTPUT_STRIP_TRAILING_WHITESPACE
  COMMAND_ERROR_IS_FATAL ANY
)
set(hgma_prefixes "")
foreach(site IN LISTS hgma_site_packages)
  get_filename_component(prefix "${site}/../../.." ABSOLUTE)  # <prefix>/lib/pythonX.Y/site-packages
  if(EXISTS "${prefix}/share/ament_cmake")
    list(APPEND hgma_prefixes "${prefix}")
  endif()
endforeach()
if(NOT hgma_prefixes)
  message(FATAL_ERROR "No ament_cmake beside any of ${hgma_site_packages}")
endif()
list(PREPEND CMAKE_PREFIX_PATH ${hgma_prefixes})
list(JOIN hgma_prefixes ":" hgma_ament_prefix_path)
set(ENV{AMENT_PREFIX_PATH} "${hgma_ament_prefix_path}")

# The exported Python generator targets of the wheels name an include directory of the machine that built
# them, which CMake refuses because it does not exist here. The path is that of numpy, found again anyway.
foreach(package std_msgs builtin_interfaces service_msgs action_msgs unique_identifier_msgs)
  find_package(${package} QUIET)
  set(target "${package}::${package}__rosidl_generator_py")
  if(TARGET ${target})
    set_property(TARGET ${target} PROPERTY INTERFACE_INCLUDE_DIRECTORIES "")
  endif()
endforeach()
