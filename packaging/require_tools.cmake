# Without these the package would be made without the libraries that it depends on, and only a warning.
foreach(tool IN ITEMS dpkg-shlibdeps file)
  find_program(${tool}_found ${tool})
  if(NOT ${tool}_found)
    message(FATAL_ERROR "${tool} is missing, which says what the package depends on: apt install dpkg-dev file")
  endif()
endforeach()
