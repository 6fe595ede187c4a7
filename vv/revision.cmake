# Embeds the revision of the sources, and a hash of the libraries that simulate, in the program. Included, it adds the target that looks the revision up at
# every build; run as a script by that target, it writes the source file, which changes only if one of them did.
if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -E env GIT_OPTIONAL_LOCKS=0
            git -c safe.directory=${source_directory} describe --always --dirty
    WORKING_DIRECTORY ${source_directory}
    OUTPUT_VARIABLE revision OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE result)
  if(NOT result EQUAL 0 OR revision STREQUAL "")
    set(revision unknown)
  endif()
  set(simulation "")
  foreach(library IN LISTS libraries)
    file(SHA256 ${library} hash)
    string(SHA256 simulation "${simulation}${hash}")
  endforeach()
  string(SUBSTRING "${simulation}" 0 16 simulation)
  configure_file(${CMAKE_CURRENT_LIST_DIR}/revision.cpp.in ${output} @ONLY)
  return()
endif()

# Adds the generated source to a target; further arguments are the static libraries that simulate.
function(mpmvv_embed_revision target)
  list(TRANSFORM ARGN REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE libraries)
  set(output ${CMAKE_CURRENT_BINARY_DIR}/revision.cpp)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" upper_build_type)
  get_target_property(options mpmvv_options INTERFACE_COMPILE_OPTIONS)
  list(FILTER options EXCLUDE REGEX "^-W")
  list(JOIN options " " options)
  set(build "${CMAKE_BUILD_TYPE} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${upper_build_type}} ${options}")
  string(REGEX REPLACE " +" " " build "${build}")
  string(STRIP "${build}" build)
  add_custom_target(${target}_revision
    COMMAND ${CMAKE_COMMAND} "-Dsource_directory=${PROJECT_SOURCE_DIR}" "-Doutput=${output}"
            "-Dversion=${PROJECT_VERSION}" "-Dcompiler=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}"
            "-Dbuild=${build}" "-Dlibraries=${libraries}" -P ${PROJECT_SOURCE_DIR}/vv/revision.cmake
    BYPRODUCTS ${output}
    COMMENT "Looking up the revision"
    VERBATIM)
  target_sources(${target} PRIVATE ${output})
  add_dependencies(${target}_revision ${ARGN})
  add_dependencies(${target} ${target}_revision)
endfunction()
