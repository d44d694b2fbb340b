"""`python -m glint`: the version of the library and the devices that it finds."""
import glint


def main() -> None:
    """Prints the version and one line for each device."""
    print("glint " + ".".join(map(str, glint.version())))
    for device in glint.devices():
        kind = "double precision on the processor" if device["reference"] else "software" if device["software"] else "Vulkan"
        print(f"{device['index']}  {device['name']} ({kind})" + (f": {device['reason']}" if device["reason"] else ""))


main()
