"""Forces by name: in pairs, at pins, of drivers, on links, on the frame; figures of them."""
