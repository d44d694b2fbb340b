# Tests with the label gpu run on Mesa's lavapipe, whatever else the machine has: the same device everywhere, and no GPU needed.

# Sets `out` to the NAME=value pairs that make the Vulkan loader see lavapipe only.
function(glint_lavapipe_environment out)
  set(folders /usr/share/vulkan/icd.d /etc/vulkan/icd.d /usr/local/share/vulkan/icd.d /usr/local/etc/vulkan/icd.d)
  list(TRANSFORM folders APPEND "/lvp_icd*.json" OUTPUT_VARIABLE patterns)
  file(GLOB found ${patterns})
  list(APPEND found "")
  list(GET found 0 first)
  set(GLINT_LAVAPIPE_ICD "${first}" CACHE FILEPATH "Lavapipe's driver file, from the Debian package mesa-vulkan-drivers")
  set(icd "${GLINT_LAVAPIPE_ICD}")
  if(NOT EXISTS "${icd}")
    # Without a driver the tests fail, each with the message that no Vulkan device was found; none is skipped.
    message(WARNING "no lvp_icd*.json in ${folders}: tests with the label gpu will fail. Install the Debian package "
                    "mesa-vulkan-drivers, or set GLINT_LAVAPIPE_ICD.")
    set(icd "${CMAKE_BINARY_DIR}/lavapipe_not_found_install_mesa-vulkan-drivers.json")
    unset(GLINT_LAVAPIPE_ICD CACHE)
  endif()
  # Loaders before 1.3.207 know the second name only.
  set(${out} "VK_DRIVER_FILES=${icd}" "VK_ICD_FILENAMES=${icd}" PARENT_SCOPE)
endfunction()
