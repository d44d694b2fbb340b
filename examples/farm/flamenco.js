// Renders one image on Flamenco 3: put this file into the folder "scripts" beside the Manager. The paths must be the
// same on all Workers, and glint in their PATH.
const JOB_TYPE = {
    label: "glint: one image in parts",
    settings: [
        { key: "scene", type: "string", required: true, description: "scene or model" },
        { key: "picture", type: "string", required: true, description: "image to write: .png .exr .pfm .hdr" },
        { key: "parts", type: "int32", default: 16 },
    ]
};

function compileJob(job) {
    const { scene, picture, parts } = job.settings;
    const merge = author.Task("merge", "misc");
    const files = [];
    for (let part = 1; part <= parts; part++) {
        files.push(`${picture}.${part}.part`);
        const draw = author.Task(`draw-${part}`, "misc");
        draw.addCommand(author.Command("exec", {
            exe: "glint", args: ["render", scene, "--part", `${part}/${parts}`, "-o", files[part - 1]],
        }));
        job.addTask(draw);
        merge.addDependency(draw);
    }
    merge.addCommand(author.Command("exec", { exe: "glint", args: ["merge", ...files, "-o", picture] }));
    job.addTask(merge);
}
