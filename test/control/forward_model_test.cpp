// The forward model over a bar of six hexahedral cells with two cables.
