#[path = "where.rs"]
mod whereis;

fn main() {
    for f in ["scenes.c", "pe.h", "ad_box3d.c"] {
        println!("cargo:rerun-if-changed=../../{f}");
    }
    let dir = whereis::folder_of("boxddd-sys");
    cc::Build::new()
        .files(["../ad_box3d.c", "../scenes.c"])
        .include("..")
        .include(dir.join("third-party/box3d/include"))
        .define("PE_NO_MAIN", None)
        .define("PE_NAME", Some("\"box3d\""))
        .opt_level(2)
        .compile("scenes");
    println!("cargo:rustc-link-lib=m");
}
