# Builds a text file into a program.
#
#   embed_text(<target> <file> <namespace> <function>)
#
# adds to <target> a source that defines `std::string_view <namespace>::<function>()`, the text of <file>; it is
# written anew whenever the file changes.

set(EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})

function(embed_text target file namespace function)
  cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${function}_text.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -D TEXT_FILE=${file} -D SOURCE=${source} -D NAMESPACE=${namespace} -D FUNCTION=${function}
            -P ${EMBED_SCRIPT}
    DEPENDS ${file} ${EMBED_SCRIPT}
    COMMENT "Embedding ${file}"
    VERBATIM)
  target_sources(${target} PRIVATE ${source})
endfunction()

# The same file, run as a script by the command above.
if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  file(READ "${TEXT_FILE}" text)
  file(WRITE "${SOURCE}" "#include <string_view>\n\nnamespace ${NAMESPACE} {\n\n"
       "std::string_view ${FUNCTION}();\n"
       "std::string_view ${FUNCTION}() {\n  return R\"embedded(${text})embedded\";\n}\n\n"
       "}  // namespace ${NAMESPACE}\n")
endif()
