# Sources that are there already, so that the tree configures while files still arrive.
# Temporary: goes away with the last `nuno_keep_existing`.
function(nuno_keep_existing variable)
  file(GLOB ignored CONFIGURE_DEPENDS "${CMAKE_CURRENT_SOURCE_DIR}/*.cpp") # configures again
  set(existing)
  foreach(source IN LISTS ${variable})
    if(EXISTS "${CMAKE_CURRENT_SOURCE_DIR}/${source}")
      list(APPEND existing ${source})
    endif()
  endforeach()
  if(NOT existing)
    file(TOUCH "${CMAKE_CURRENT_BINARY_DIR}/empty.cpp")
    set(existing "${CMAKE_CURRENT_BINARY_DIR}/empty.cpp")
  endif()
  set(${variable} ${existing} PARENT_SCOPE)
endfunction()
