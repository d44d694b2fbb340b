# What a program brings along where it is installed: man pages and completions for shells, which it makes itself from the texts of its
# --help, and for the window an icon, an entry in menus and the types of scenes. Component: program. Included by src/app.
include(GNUInstallDirs)
if(CMAKE_CROSSCOMPILING)
  return()
endif()
set(glint_pages ${CMAKE_BINARY_DIR}/pages)
add_custom_command(OUTPUT ${glint_pages}/man/man1/glint.1
  COMMAND ${CMAKE_COMMAND} -E make_directory ${glint_pages}
  COMMAND glint pages ${glint_pages} >${glint_pages}/list
  DEPENDS glint COMMENT "Making man pages and completions")
add_custom_target(glint_pages ALL DEPENDS ${glint_pages}/man/man1/glint.1)
foreach(folder man bash-completion zsh fish)
  install(DIRECTORY ${glint_pages}/${folder} DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
endforeach()
if(GLINT_WINDOW)
  install(DIRECTORY ${CMAKE_SOURCE_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
endif()
